/* `group` of match_group.h in vectors of NEON (AArch64): VECTORS of 8 lanes. The including file defines VISTA_TARGET,
 * VISTA_INLINE and VECTORS, 2 or 4. */
#ifndef VISTA_ENGINE_GROUP_NEON_H
#define VISTA_ENGINE_GROUP_NEON_H

#include "items_neon.h"

enum { LANES = 8 * VECTORS };

typedef struct group {
  uint16x8_t of[VECTORS];
} group;

/* The same for every vector of a group; the compiler unrolls it. */
#define VISTA_EACH(expression)                                  \
  do {                                                          \
    for (int i = 0; i < VECTORS; ++i) out.of[i] = (expression); \
  } while (0)

VISTA_INLINE group group_fill(uint32_t value) {
  group out;
  VISTA_EACH(vdupq_n_u16((uint16_t)value));
  return out;
}

VISTA_INLINE group group_fill_pair(uint32_t pair) {
  group out;
  VISTA_EACH(vreinterpretq_u16_u32(vdupq_n_u32(pair)));
  return out;
}

VISTA_INLINE group group_load(const uint16_t *at) {
  group out;
  VISTA_EACH(vld1q_u16(at + 8 * i));
  return out;
}

VISTA_INLINE void group_store(uint16_t *at, group a) {
  for (int i = 0; i < VECTORS; ++i) vst1q_u16(at + 8 * i, a.of[i]);
}

VISTA_INLINE group group_add(group a, group b) {
  group out;
  VISTA_EACH(vaddq_u16(a.of[i], b.of[i]));
  return out;
}

VISTA_INLINE group group_sub(group a, group b) {
  group out;
  VISTA_EACH(vsubq_u16(a.of[i], b.of[i]));
  return out;
}

VISTA_INLINE group group_min(group a, group b) {
  group out;
  VISTA_EACH(vminq_u16(a.of[i], b.of[i]));
  return out;
}

VISTA_INLINE group group_or(group a, group b) {
  group out;
  VISTA_EACH(vorrq_u16(a.of[i], b.of[i]));
  return out;
}

/* Bit d of lane d, which is all ones or all zeros: each byte keeps one bit of its own, and neighbours are added up. */
VISTA_INLINE uint32_t mask_bits(group a) {
  static const uint8_t weights[16] = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
  const uint8x16_t own = vld1q_u8(weights);
  uint8x16_t bytes[2];
  for (int i = 0; i < 2; ++i) { /* the low bytes of two vectors */
    const int k = 2 * i < VECTORS ? 2 * i : 0;
    bytes[i] = vuzp1q_u8(vreinterpretq_u8_u16(a.of[k]), vreinterpretq_u8_u16(a.of[k + 1]));
    bytes[i] = vandq_u8(bytes[i], own);
  }
  const uint8x16_t pairs = vpaddq_u8(bytes[0], bytes[1]), fours = vpaddq_u8(pairs, pairs);
  const uint32_t bits = vgetq_lane_u32(vreinterpretq_u32_u8(vpaddq_u8(fours, fours)), 0);
  return VECTORS == 2 ? bits & 0xFFFF : bits;
}

VISTA_INLINE uint32_t group_equal(group a, group b) {
  group out;
  VISTA_EACH(vceqq_u16(a.of[i], b.of[i]));
  return mask_bits(out);
}

VISTA_INLINE uint32_t group_at_most(group a, group b) {
  group out;
  VISTA_EACH(vcleq_u16(a.of[i], b.of[i]));
  return mask_bits(out);
}

VISTA_INLINE group group_pad(int first) {
  uint16_t lanes[LANES];
  for (int i = 0; i < LANES; ++i) lanes[i] = i >= first ? 0xFFFF : 0;
  return group_load(lanes);
}

VISTA_INLINE uint32_t group_top(group a) { return vgetq_lane_u16(a.of[VECTORS - 1], 7); }

VISTA_INLINE group group_up(group a, group below) {
  group out;
  VISTA_EACH(vextq_u16(i == 0 ? below.of[VECTORS - 1] : a.of[i == 0 ? 0 : i - 1], a.of[i], 7));
  return out;
}

VISTA_INLINE group group_pick(group low, group high, group a, group b) {
  group out;
  VISTA_EACH(vbslq_u16(vcleq_u16(low.of[i], high.of[i]), a.of[i], b.of[i]));
  return out;
}

/* |left_in - right_in| - |left_out - right_out| */
VISTA_INLINE group group_cost_change(uint8_t left_in, uint8_t left_out, const uint8_t *right_in,
                                     const uint8_t *right_out, int full_range) {
  (void)full_range; /* the same for all pixels */
  const uint8x16_t l_in = vdupq_n_u8(left_in), l_out = vdupq_n_u8(left_out);
  group out;
  for (int i = 0; i < VECTORS; i += 2) {
    const uint8x16_t enters = vabdq_u8(l_in, vld1q_u8(right_in + 8 * i));
    const uint8x16_t leaves = vabdq_u8(l_out, vld1q_u8(right_out + 8 * i));
    out.of[i] = vsubl_u8(vget_low_u8(enters), vget_low_u8(leaves));
    out.of[i + 1] = vsubl_high_u8(enters, leaves);
  }
  return out;
}

#undef VISTA_EACH
#endif
