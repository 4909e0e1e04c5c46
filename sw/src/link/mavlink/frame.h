/* A MAVLink 2 frame around a payload. */
#ifndef VISTA_SRC_MAVLINK_FRAME_H
#define VISTA_SRC_MAVLINK_FRAME_H

#include <stdint.h>

#define VISTA_MAVLINK_HEADER 10
#define VISTA_MAVLINK_CRC_START 0xFFFF

/* CRC-16/MCRF4XX, which MAVLink calls X.25, with one more byte. */
uint16_t vista_mavlink_add_to_crc(uint16_t crc, uint8_t byte);

/* Who sends, and the number of the frame. */
typedef struct vista_mavlink_sender {
  uint8_t system_id, component_id, sequence;
} vista_mavlink_sender;

/* Completes the frame whose payload of so many bytes begins at bytes[VISTA_MAVLINK_HEADER]: header, and checksum behind
 * the payload, from which zeros at the end are cut. Returns the length of the frame. */
int32_t vista_mavlink_close(const vista_mavlink_sender *sender, uint32_t message_id, uint8_t crc_extra,
                            int32_t payload_bytes, uint8_t *bytes);

#endif
