#include "link/mavlink/frame.h"

#define MAGIC 0xFD

uint16_t vista_mavlink_add_to_crc(uint16_t crc, uint8_t byte) {
  uint8_t t = (uint8_t)(byte ^ (crc & 0xFF));
  t = (uint8_t)(t ^ (t << 4));
  return (uint16_t)((crc >> 8) ^ (t << 8) ^ (t << 3) ^ (t >> 4));
}

int32_t vista_mavlink_close(const vista_mavlink_sender *sender, uint32_t message_id, uint8_t crc_extra,
                            int32_t payload_bytes, uint8_t *bytes) {
  uint8_t *const payload = bytes + VISTA_MAVLINK_HEADER;
  while (payload_bytes > 1 && payload[payload_bytes - 1] == 0) --payload_bytes;
  const uint8_t header[VISTA_MAVLINK_HEADER] = {MAGIC,
                                                (uint8_t)payload_bytes,
                                                0, /* flags that a receiver must, and that it may understand */
                                                0,
                                                sender->sequence,
                                                sender->system_id,
                                                sender->component_id,
                                                (uint8_t)message_id,
                                                (uint8_t)(message_id >> 8),
                                                (uint8_t)(message_id >> 16)};
  uint16_t crc = VISTA_MAVLINK_CRC_START;
  for (int k = 0; k < VISTA_MAVLINK_HEADER; ++k) bytes[k] = header[k];
  for (int32_t k = 1; k < VISTA_MAVLINK_HEADER + payload_bytes; ++k) crc = vista_mavlink_add_to_crc(crc, bytes[k]);
  crc = vista_mavlink_add_to_crc(crc, crc_extra);
  payload[payload_bytes] = (uint8_t)(crc & 0xFF);
  payload[payload_bytes + 1] = (uint8_t)(crc >> 8);
  return VISTA_MAVLINK_HEADER + payload_bytes + 2;
}
