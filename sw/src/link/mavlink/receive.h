/* Frames of MAVLink 1 and 2 out of a stream of bytes. */
#ifndef VISTA_SRC_MAVLINK_RECEIVE_H
#define VISTA_SRC_MAVLINK_RECEIVE_H

#include <stdbool.h>
#include <stdint.h>

#define VISTA_MAVLINK_PAYLOAD_MOST 255

/* A message with its payload, filled up with zeros. */
typedef struct vista_mavlink_message {
  uint32_t id;
  uint8_t system_id, component_id;
  uint8_t payload[VISTA_MAVLINK_PAYLOAD_MOST];
} vista_mavlink_message;

/* Looks at the bytes for a frame at their beginning. Returns how many of them are done with, 0: more are needed.
 * *there: they are a message that somebody here reads, and its checksum is right. */
int32_t vista_mavlink_scan(const uint8_t *bytes, int32_t count, vista_mavlink_message *message, bool *there);

#endif
