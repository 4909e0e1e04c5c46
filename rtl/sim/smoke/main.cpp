// SPDX-License-Identifier: Apache-2.0
/* One frame of noise through the Verilated engine: the right image is the left one, moved by some pixels, and every
 * word that is matched has to say so. For the target `sim` of rtl/vista_stereo.core; the benches are in tb/. */
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

extern "C" {
#include "vista_rtl.h"
}

namespace {

constexpr int kHeight = 40, kShiftPx = 7, kHalfPx = 8, kInvalid = -16;
constexpr uint32_t kUser = 1u << 16, kLast = 1u << 17;
constexpr uint32_t kSize = 0x14, kControl = 0x10, kCommit = 0x48, kErrors = 0x28, kBuild = 0x08;

}  // namespace

int main() {
  vista_rtl* const engine = vista_rtl_create(1);
  const uint32_t build = vista_rtl_read(engine, kBuild);
  const int disparities = build & 0x1FF, block = build >> 16 & 0x1F, width = disparities + 4 * block;
  std::mt19937 random(1);
  std::vector<uint8_t> noise(static_cast<size_t>(width + kShiftPx) * kHeight);
  for (uint8_t& pixel : noise) pixel = static_cast<uint8_t>(random());
  std::vector<uint32_t> beats, words(static_cast<size_t>(width) * kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < width; ++x) {
      const uint8_t* const row = &noise[static_cast<size_t>(y) * (width + kShiftPx)];
      beats.push_back(row[x] | row[x + kShiftPx] << 8 | (x == 0 && y == 0 ? kUser : 0) | (x == width - 1 ? kLast : 0));
    }
  vista_rtl_write(engine, kSize, static_cast<uint32_t>(width) | kHeight << 16);
  vista_rtl_write(engine, kCommit, 1);
  vista_rtl_write(engine, kControl, 1);
  const uint32_t pace[2] = {100, 500};
  std::vector<uint8_t> flags(words.size());
  int64_t taken = 0;
  const int64_t count = vista_rtl_stream(engine, beats.data(), static_cast<int64_t>(beats.size()), pace, pace, 1,
                                         static_cast<int64_t>(words.size()), 100000, INT64_MAX, words.data(),
                                         flags.data(), nullptr, nullptr, &taken);
  int valid = 0, right = 0;
  for (const uint32_t word : words) {
    const int disparity = static_cast<int16_t>(word);
    valid += disparity != kInvalid;
    right += std::abs(disparity - 16 * kShiftPx) <= kHalfPx;
  }
  const bool sound =
      count == static_cast<int64_t>(words.size()) && vista_rtl_read(engine, kErrors) == 0 && !vista_rtl_failed(engine);
  std::printf("%lld words, %d of them matched, %d as the image was moved\n", static_cast<long long>(count), valid,
              right);
  vista_rtl_destroy(engine);
  return sound && valid > 0 && right == valid ? EXIT_SUCCESS : EXIT_FAILURE;
}
