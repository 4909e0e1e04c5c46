// SPDX-License-Identifier: Apache-2.0
// Whole frames through the Verilated engine, the way a product's driver runs them: registers by the generated header,
// then one pair in and its words out. Uses nothing but the rest of vista_rtl.h.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "../csr/vista_stereo_csr.h"
extern "C" {
#include "vista_rtl.h"
}

namespace {

#define ADDRESS(name) static_cast<uint32_t>(offsetof(vista_stereo_csr_t, name))
#define FIELD(name, value) \
  ((static_cast<uint32_t>(value) << VISTA_STEREO_CSR__##name##_bp) & VISTA_STEREO_CSR__##name##_bm)
#define READ_FIELD(data, name) (((data) & VISTA_STEREO_CSR__##name##_bm) >> VISTA_STEREO_CSR__##name##_bp)

constexpr uint32_t kUser = 1u << 16, kLast = 1u << 17;  // of a beat
constexpr uint32_t kEveryClock[2] = {0, 1000};
constexpr int64_t kQuietClocks = 100000;  // more than the engine is ever silent with a frame inside: two dozen rows
constexpr int16_t kInvalid = -16;
constexpr int32_t kStepPx = 16;           // from one control point to the next
constexpr uint32_t kMinWidth = 4, kMinHeight = 2;  // of a level that is sent
constexpr uint32_t kMapErrors = VISTA_STEREO_CSR__ERRORS__MAP_ROWS_bm | VISTA_STEREO_CSR__ERRORS__MAP_SIZE_bm;
constexpr int kReadyReads = 8;  // a bank is free again some clocks after the other one came into force

struct Level {
  int64_t width, height;
  bool sent;
  int64_t words() const { return width * height; }
};

std::vector<Level> levels_of(int64_t width, int64_t height, uint32_t count) {
  std::vector<Level> levels;
  for (bool sent = true; levels.size() < count; width = (width + 1) / 2, height = (height + 1) / 2) {
    sent = sent && (levels.empty() || (width >= kMinWidth && height >= kMinHeight));
    levels.push_back({width, height, sent});
  }
  return levels;
}

int64_t words_of(const std::vector<Level>& levels, bool sent_only) {
  int64_t words = 0;
  for (const Level& level : levels) words += level.sent || !sent_only ? level.words() : 0;
  return words;
}

bool has_front_end(vista_rtl* engine) {
  return READ_FIELD(vista_rtl_read(engine, ADDRESS(BUILD_FRONT_END)), BUILD_FRONT_END__RECTIFY_ROWS) != 0;
}

void configure(vista_rtl* engine, const vista_rtl_settings& settings, int32_t width, int32_t height) {
  // No texture sum (at most 441 * 63) and no difference of disparities reaches these.
  const uint32_t texture = std::min(settings.texture_threshold, 0xFFFFu);
  const uint32_t max_diff = static_cast<uint32_t>(std::clamp(settings.lr_max_diff, 0, 255));
  vista_rtl_write(engine, ADDRESS(SIZE), FIELD(SIZE__WIDTH, width) | FIELD(SIZE__HEIGHT, height));
  vista_rtl_write(engine, ADDRESS(PREFILTER),
                  FIELD(PREFILTER__XSOBEL, settings.xsobel) | FIELD(PREFILTER__CAP, settings.prefilter_cap));
  vista_rtl_write(engine, ADDRESS(TEXTURE), FIELD(TEXTURE__THRESHOLD, texture));
  vista_rtl_write(engine, ADDRESS(UNIQUENESS), FIELD(UNIQUENESS__RATIO, settings.uniqueness_ratio));
  vista_rtl_write(engine, ADDRESS(LR_CHECK),
                  FIELD(LR_CHECK__ENABLE, settings.lr_max_diff >= 0) | FIELD(LR_CHECK__MAX_DIFF, max_diff));
  vista_rtl_write(engine, ADDRESS(OUTPUT), FIELD(OUTPUT__NARROW, 0));
  vista_rtl_write(engine, ADDRESS(FRONT_END),
                  FIELD(FRONT_END__SMOOTH, settings.smooth) | FIELD(FRONT_END__RECTIFY, settings.rectify) |
                      FIELD(FRONT_END__LEVELS, settings.levels));
  vista_rtl_write(engine, ADDRESS(COMMIT), FIELD(COMMIT__COMMIT, 1));
  vista_rtl_write(engine, ADDRESS(CONTROL), FIELD(CONTROL__ENABLE, 1));
}

// Drops what is inside, and takes the words that a soft reset leaves.
void drop_all(vista_rtl* engine) {
  vista_rtl_write(engine, ADDRESS(CONTROL), FIELD(CONTROL__SOFT_RESET, 1));
  uint32_t words[2];
  uint8_t flags[2];
  int64_t taken;
  vista_rtl_stream(engine, nullptr, 0, kEveryClock, kEveryClock, 1, 2, 2, INT64_MAX, words, flags, nullptr, nullptr,
                   &taken);
}

std::vector<uint32_t> video(const uint8_t* left, const uint8_t* right, int64_t width, int64_t height) {
  std::vector<uint32_t> beats(static_cast<size_t>(width * height));
  for (int64_t i = 0; i < width * height; ++i)
    beats[i] = left[i] | static_cast<uint32_t>(right[i]) << 8 | (i % width == width - 1 ? kLast : 0);
  beats[0] |= kUser;
  return beats;
}

}  // namespace

extern "C" {

int32_t vista_rtl_identify(vista_rtl* engine, vista_rtl_build* build) {
  if (vista_rtl_read(engine, ADDRESS(ID)) != VISTA_STEREO_CSR__ID__MAGIC_reset) return 0;
  if (READ_FIELD(vista_rtl_read(engine, ADDRESS(VERSION)), VERSION__MAJOR) != VISTA_STEREO_CSR__VERSION__MAJOR_reset)
    return 0;
  const uint32_t parameters = vista_rtl_read(engine, ADDRESS(BUILD));
  const uint32_t size = vista_rtl_read(engine, ADDRESS(BUILD_SIZE));
  build->num_disparities = READ_FIELD(parameters, BUILD__NUM_DISPARITIES);
  build->block_size = READ_FIELD(parameters, BUILD__BLOCK_SIZE);
  build->max_width_px = READ_FIELD(size, BUILD_SIZE__MAX_WIDTH);
  build->max_height_px = READ_FIELD(size, BUILD_SIZE__MAX_HEIGHT);
  const uint32_t front_end = vista_rtl_read(engine, ADDRESS(BUILD_FRONT_END));
  build->rectify_rows = READ_FIELD(front_end, BUILD_FRONT_END__RECTIFY_ROWS);
  build->map_points = READ_FIELD(front_end, BUILD_FRONT_END__MAP_POINTS);
  return 1;
}

uint32_t vista_rtl_load_map(vista_rtl* engine, const int16_t* left, const int16_t* right, int32_t width,
                            int32_t height) {
  if (!has_front_end(engine)) return VISTA_STEREO_CSR__ERRORS__MAP_SIZE_bm;
  bool ready = false;
  for (int i = 0; i < kReadyReads && !ready; ++i) ready = READ_FIELD(vista_rtl_read(engine, ADDRESS(MAP)), MAP__READY);
  // A frame that was left behind half would keep its map for ever.
  if (!ready) drop_all(engine);
  vista_rtl_write(engine, ADDRESS(SIZE), FIELD(SIZE__WIDTH, width) | FIELD(SIZE__HEIGHT, height));
  vista_rtl_write(engine, ADDRESS(ERRORS), kMapErrors);
  vista_rtl_write(engine, ADDRESS(MAP), FIELD(MAP__BEGIN_LOAD, 1));
  const int64_t points =
      static_cast<int64_t>((width + kStepPx - 1) / kStepPx + 1) * ((height + kStepPx - 1) / kStepPx + 1);
  for (const int16_t* camera : {left, right})
    for (int64_t i = 0; i < 2 * points; i += 2) {
      const uint16_t dx = static_cast<uint16_t>(camera[i]), dy = static_cast<uint16_t>(camera[i + 1]);
      vista_rtl_write(engine, ADDRESS(MAP_POINT), FIELD(MAP_POINT__DX, dx) | FIELD(MAP_POINT__DY, dy));
    }
  vista_rtl_write(engine, ADDRESS(COMMIT), FIELD(COMMIT__MAP, 1));
  return vista_rtl_read(engine, ADDRESS(ERRORS)) & kMapErrors;
}

int64_t vista_rtl_compute(vista_rtl* engine, const vista_rtl_settings* settings, const uint8_t* left,
                          const uint8_t* right, int32_t width, int32_t height, int16_t* disparity) {
  const bool needs_front_end = settings->smooth || settings->levels != 1 || settings->rectify;
  if (needs_front_end && !has_front_end(engine)) return -1;
  configure(engine, *settings, width, height);
  const std::vector<uint32_t> beats = video(left, right, width, height);
  const std::vector<Level> levels = levels_of(width, height, settings->levels);
  const int64_t pixels = static_cast<int64_t>(beats.size()), sent = words_of(levels, true);
  std::vector<uint32_t> words(static_cast<size_t>(sent));
  std::vector<uint8_t> flags(words.size());
  std::vector<int64_t> in_clock(beats.size()), out_clock(words.size());
  int64_t taken = 0;
  vista_rtl_write(engine, ADDRESS(ERRORS), ~0u);  // of frames before this one
  const int64_t count =
      vista_rtl_stream(engine, beats.data(), pixels, kEveryClock, kEveryClock, 1, sent, kQuietClocks, INT64_MAX,
                       words.data(), flags.data(), in_clock.data(), out_clock.data(), &taken);
  const bool sound = vista_rtl_read(engine, ADDRESS(ERRORS)) == 0;
  if (count != sent || taken != pixels || !sound || vista_rtl_failed(engine)) {
    drop_all(engine);  // whatever is left inside would come before the next frame
    return -1;
  }
  // {Smin[15:0], disparity[15:0]}; a level that is not sent has nothing that could be matched.
  std::transform(words.begin(), words.end(), disparity, [](uint32_t word) { return static_cast<int16_t>(word); });
  std::fill(disparity + sent, disparity + words_of(levels, false), kInvalid);
  return out_clock.back() - in_clock.front() + 1;
}
}
