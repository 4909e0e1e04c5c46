#include "link/mavlink/receive.h"

#include <string.h>

#include "link/mavlink/frame.h"
#include "link/mavlink/wire.h"

#define MAGIC_1 0xFE
#define MAGIC_2 0xFD
#define HEADER_1 6
#define SIGNED 1 /* of the flags that a receiver must understand */
#define SIGNATURE_BYTES 13
#define CHECKSUM_BYTES 2

/* The byte that stands for the layout of a message in its checksum; -1: a message that nobody here reads. */
static int crc_extra_of(uint32_t id) {
  switch (id) {
    case WIRE_ATTITUDE_QUATERNION_ID:
      return WIRE_ATTITUDE_QUATERNION_CRC_EXTRA;
    case WIRE_LOCAL_POSITION_NED_ID:
      return WIRE_LOCAL_POSITION_NED_CRC_EXTRA;
    case WIRE_HEARTBEAT_ID:
      return WIRE_HEARTBEAT_CRC_EXTRA;
    default:
      return -1;
  }
}

static bool is_whole(const uint8_t *bytes, int32_t end, int crc_extra) {
  uint16_t crc = VISTA_MAVLINK_CRC_START;
  for (int32_t k = 1; k < end; ++k) crc = vista_mavlink_add_to_crc(crc, bytes[k]);
  crc = vista_mavlink_add_to_crc(crc, (uint8_t)crc_extra);
  return bytes[end] == (crc & 0xFF) && bytes[end + 1] == crc >> 8;
}

int32_t vista_mavlink_scan(const uint8_t *bytes, int32_t count, vista_mavlink_message *message, bool *there) {
  *there = false;
  if (count < 1) return 0;
  const bool second = bytes[0] == MAGIC_2;
  if (!second && bytes[0] != MAGIC_1) return 1;
  const int32_t header = second ? VISTA_MAVLINK_HEADER : HEADER_1;
  if (count < header) return 0;
  const int32_t end = header + bytes[1];
  const int32_t frame = end + CHECKSUM_BYTES + (second && (bytes[2] & SIGNED) ? SIGNATURE_BYTES : 0);
  if (count < frame) return 0;
  message->id = second ? (uint32_t)wire_get(bytes + 7, 3) : bytes[5];
  message->system_id = bytes[second ? 5 : 3];
  message->component_id = bytes[second ? 6 : 4];
  const int crc_extra = crc_extra_of(message->id);
  if (crc_extra < 0) return frame;
  if (!is_whole(bytes, end, crc_extra)) return 1;
  memset(message->payload, 0, sizeof message->payload);
  memcpy(message->payload, bytes + header, bytes[1]);
  *there = true;
  return frame;
}
