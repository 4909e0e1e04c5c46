/* The way of MAVLink to the autopilot and back: UDP, or a serial line. Nothing blocks and nothing queues up; a receiver or an
 * adapter that is lost is waited for. */
#ifndef VISTA_FLY_TRANSPORT_H
#define VISTA_FLY_TRANSPORT_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

#include "problem.h"

#define TRANSPORT_DEVICE_BYTES 256

typedef struct transport {
  int file; /* -1: gone */
  bool serial;
  struct sockaddr_storage address; /* of UDP */
  socklen_t address_bytes;
  char device[TRANSPORT_DEVICE_BYTES]; /* of a serial line */
  uint32_t speed;
  int64_t tried_ns; /* when it was last opened */
  int64_t lost; /* messages that found no way */
} transport;

/* target: udp:ADDRESS:PORT, with a numeric address or localhost, or serial:DEVICE[:BAUD]. listen_port: of UDP, where
 * the other side may send to; 0: any. */
bool transport_open(transport *t, const char *target, int listen_port, problem *p);

void transport_send(transport *t, const uint8_t *bytes, int32_t count);

/* Waits at most so long for bytes, of UDP from the target's address alone. Returns their number. */
int32_t transport_receive(transport *t, int timeout_ms, uint8_t *bytes, int32_t capacity);

void transport_close(transport *t);

#endif
