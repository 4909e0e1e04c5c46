/* Eight pixels at a time in vectors of NEON (AArch64): as items_x86.h. The including file defines VISTA_INLINE. */
#ifndef VISTA_ENGINE_ITEMS_NEON_H
#define VISTA_ENGINE_ITEMS_NEON_H

#include <arm_neon.h>
#include <stdint.h>

typedef uint16x8_t words8;
typedef struct items8 {
  uint32x4_t low, high;
} items8;

VISTA_INLINE items8 items_load(const void *at) {
  const uint32_t *items = (const uint32_t *)at;
  return (items8){vld1q_u32(items), vld1q_u32(items + 4)};
}

VISTA_INLINE void items_store(void *at, items8 a) {
  uint32_t *items = (uint32_t *)at;
  vst1q_u32(items, a.low);
  vst1q_u32(items + 4, a.high);
}

VISTA_INLINE items8 items_fill(int32_t value) {
  const uint32x4_t all = vdupq_n_u32((uint32_t)value);
  return (items8){all, all};
}

VISTA_INLINE items8 items_add(items8 a, items8 b) {
  return (items8){vaddq_u32(a.low, b.low), vaddq_u32(a.high, b.high)};
}

VISTA_INLINE items8 items_sub(items8 a, items8 b) {
  return (items8){vsubq_u32(a.low, b.low), vsubq_u32(a.high, b.high)};
}

VISTA_INLINE items8 items_and(items8 a, items8 b) {
  return (items8){vandq_u32(a.low, b.low), vandq_u32(a.high, b.high)};
}

VISTA_INLINE items8 items_or(items8 a, items8 b) {
  return (items8){vorrq_u32(a.low, b.low), vorrq_u32(a.high, b.high)};
}

VISTA_INLINE items8 items_without(items8 a, items8 bits) {
  return (items8){vbicq_u32(a.low, bits.low), vbicq_u32(a.high, bits.high)};
}

VISTA_INLINE items8 items_widen(words8 a) { return (items8){vmovl_u16(vget_low_u16(a)), vmovl_high_u16(a)}; }

/* All ones where an item is 0. */
VISTA_INLINE items8 items_zero(items8 a) { return (items8){vceqzq_u32(a.low), vceqzq_u32(a.high)}; }

/* a where the mask is all ones, else b. */
VISTA_INLINE items8 items_pick(items8 mask, items8 a, items8 b) {
  return (items8){vbslq_u32(mask.low, a.low, b.low), vbslq_u32(mask.high, a.high, b.high)};
}

/* Shifted to the left by so many bits, or to the right where that is negative; beyond 31 gives 0. NEON looks at the
 * lowest byte of the number only. */
VISTA_INLINE uint32x4_t shift_4(uint32x4_t a, int32x4_t by) {
  return vshlq_u32(a, vmaxq_s32(vminq_s32(by, vdupq_n_s32(32)), vdupq_n_s32(-32)));
}

VISTA_INLINE items8 items_shift(items8 a, items8 by) {
  return (items8){shift_4(a.low, vreinterpretq_s32_u32(by.low)), shift_4(a.high, vreinterpretq_s32_u32(by.high))};
}

/* The smallest cost of each of 8 pixels of `lanes` costs. */
VISTA_INLINE words8 smallest_of_8(const uint16_t *costs, int lanes) {
  uint16x8_t partial[8];
  for (int i = 0; i < 8; ++i) {
    partial[i] = vld1q_u16(costs + i * lanes);
    for (int d = 8; d < lanes; d += 8) partial[i] = vminq_u16(partial[i], vld1q_u16(costs + i * lanes + d));
  }
  const uint16x8_t first = vpminq_u16(vpminq_u16(partial[0], partial[1]), vpminq_u16(partial[2], partial[3]));
  const uint16x8_t second = vpminq_u16(vpminq_u16(partial[4], partial[5]), vpminq_u16(partial[6], partial[7]));
  return vpminq_u16(first, second);
}

/* Smin + floor(Smin*u/100) of 8 pixels, as in items_x86.h. */
VISTA_INLINE words8 limits_of_8(words8 least, uint32_t ratio) {
  const uint16_t fraction = (uint16_t)(ratio == 100 ? 65535 : ratio * 65536 / 100);
  const uint32x4_t low = vmull_n_u16(vget_low_u16(least), fraction), high = vmull_high_n_u16(least, fraction);
  const uint16x8_t share = vshrn_high_n_u32(vshrn_n_u32(low, 16), high, 16);
  const uint16x8_t rest = vmlsq_n_u16(vmulq_n_u16(least, (uint16_t)ratio), share, 100);
  const uint16x8_t missed = vcgtq_u16(rest, vdupq_n_u16(99));
  return vminq_u16(vqaddq_u16(least, vsubq_u16(share, missed)), vdupq_n_u16(65534));
}

/* Every item twice, so that one item of 32 bits fills a group. */
VISTA_INLINE void store_twice(uint32_t *at, words8 items) {
  vst1q_u32(at, vreinterpretq_u32_u16(vzip1q_u16(items, items)));
  vst1q_u32(at + 4, vreinterpretq_u32_u16(vzip2q_u16(items, items)));
}

/* 8 items of 32 bits, each from 0 to 255, as bytes. */
VISTA_INLINE void store_bytes(uint8_t *at, items8 items) {
  vst1_u8(at, vmovn_u16(vmovn_high_u32(vmovn_u32(items.low), items.high)));
}

/* The number of the highest one of each item; of 0 it is 0. */
VISTA_INLINE uint32x4_t highest_4(uint32x4_t items) {
  return vsubq_u32(vdupq_n_u32(31), vclzq_u32(vorrq_u32(items, vdupq_n_u32(1))));
}

VISTA_INLINE items8 highest_bits(items8 items) { return (items8){highest_4(items.low), highest_4(items.high)}; }

#endif
