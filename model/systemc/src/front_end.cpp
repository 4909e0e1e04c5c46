#include "front_end.h"

#include <algorithm>

namespace vista {
namespace {

// doc/rtl.md, "Front end": clocks from the last row that a row needs to its first pixel, before each smaller level, and
// from the last pixel that smoothing needs, when it enters the pyramid, to the smoothed one.
constexpr int64_t kRowClocks = 34, kLevelClocks = 16, kPyramidClocks = 2, kSmoothClocks = 9 + kPyramidClocks;
constexpr int64_t kSmoothAhead = 2;
constexpr int64_t kSlack = 8;  // pixels that registers hold
// Of these clocks, those from the reading of a pixel to the pixel; pixels that may be read ahead; from the reading of a
// row to that of the one after the next, beside its width; and for each column of control points of a row, and beside.
constexpr int64_t kSampleClocks = 11, kReadAhead = 28, kRowsApart = 13, kPointClocks = 2;
constexpr int64_t kStepPx = 16;

}  // namespace

FrontEnd::FrontEnd(const sc_core::sc_module_name& name, const Configuration& c, Memory& memory, int64_t address,
                   BoardMemory* board)
    : sc_module(name),
      height_(c.height_px),
      rows_(c.rectify_rows),
      buffer_("levels", c, memory, address, board),
      row_came_(static_cast<size_t>(2 * c.rectify_rows)) {
  for (const clocks::Size& size : c.level_sizes()) {
    level_width_.push_back(size.width);
    level_px_.push_back(static_cast<int64_t>(size.width) * size.height);
  }
}

void FrontEnd::go_on(Place& place) const {
  if (++place.pixel < pixels(place)) return;
  place.pixel = 0;
  if (++place.level < static_cast<int64_t>(level_px_.size())) return;
  place.level = 0;
  ++place.frame;
}

bool FrontEnd::pixel_valid(int64_t clock) {
  advance(clock);
  // Smoothing needs a row and two pixels more, or all that its level has.
  const int64_t needed = std::min(width(smoothed_) + kSmoothAhead, pixels(smoothed_) - 1 - smoothed_.pixel);
  return passed_ > left_ + needed && passed_clocks_[static_cast<size_t>(needed)] + kSmoothClocks <= clock;
}

void FrontEnd::pixel_taken(int64_t) {
  go_on(smoothed_);
  ++left_;
  passed_clocks_.pop_front();
}

int64_t FrontEnd::next_pixel(int64_t clock) {
  while (!pixel_valid(clock)) {
    if (empty()) {
      clock = std::max(clock, raw->next_pixel(clock));
      clock_ = std::max(clock_, clock - 1);
    }
    if (!pixel_valid(clock)) ++clock;
  }
  return clock;
}

void FrontEnd::advance(int64_t clock) {
  while (clock_ < clock) {
    ++clock_;
    read_pixel(clock_);
    pass_pyramid(clock_);
    take_raw(clock_);
  }
}

// The line buffer holds the rows that the row which is read needs, as far as its frame has them, and two more.
void FrontEnd::take_raw(int64_t clock) {
  const int64_t width = level_width_[0], row = read_px_ / width, first = row - row % height_;
  const int64_t oldest = std::max(first, row - rows_ / 2 + 2);
  if (raw_px_ / width >= oldest + rows_ || !raw->pixel_valid(clock)) return;
  raw->pixel_taken(clock);
  ++raw_px_;
  if (raw_px_ % width == 0) came(raw_px_ / width - 1) = clock;
}

// Row y needs the rows down to y + rows / 2 - 1, as far as the frame has them, and its control points.
bool FrontEnd::row_ready(int64_t row, int64_t clock) {
  const int64_t width = level_width_[0], first = row - row % height_;
  const int64_t needed = first + std::min(row - first + rows_ / 2, height_);
  if (raw_px_ < needed * width) return false;
  const int64_t points = kPointClocks * ((width + kStepPx - 1) / kStepPx + 2);
  return clock >= came(needed - 1) + kRowClocks - kSampleClocks && clock >= row_clock_ + std::max(width, points) &&
         clock >= row_before_clock_ + width + kRowsApart;
}

void FrontEnd::read_pixel(int64_t clock) {
  if (static_cast<int64_t>(read_clocks_.size()) >= kReadAhead) return;
  if (read_px_ % level_width_[0] == 0) {
    if (!row_ready(read_px_ / level_width_[0], clock)) return;
    row_before_clock_ = row_clock_;
    row_clock_ = clock;
  }
  ++read_px_;
  read_clocks_.push_back(clock);
}

bool FrontEnd::rectified(int64_t clock) const {
  return !read_clocks_.empty() && read_clocks_.front() + kSampleClocks <= clock;
}

void FrontEnd::pass_pyramid(int64_t clock) {
  buffer_.edge(clock);
  if (passed_ - left_ > width(smoothed_) + kSmoothAhead + kSmoothClocks + kSlack) return;
  const bool more = pyramid_.level + 1 < static_cast<int64_t>(level_px_.size());
  if (more && !buffer_.has_room(clock)) return;
  if (pyramid_.level == 0 ? !rectified(clock)
                          : clock < level_clock_ + kLevelClocks || !buffer_.take(clock, width(pyramid_)))
    return;
  if (pyramid_.level == 0) read_clocks_.pop_front();
  passed_clocks_.push_back(clock);
  ++passed_;
  if (more) {
    // A pixel of the smaller level for every second one of every second row, the last rows at the end.
    const size_t next = static_cast<size_t>(pyramid_.level) + 1;
    const int64_t done = pyramid_.pixel + 1, all = pixels(pyramid_), lag = 2 * width(pyramid_) + 4;
    const int64_t past = std::max<int64_t>(0, done - lag), row = past / width(pyramid_),
                  column = past % width(pyramid_);
    const int64_t stored = done == all ? level_px_[next] : row / 2 * level_width_[next] + (row % 2 ? column / 2 : 0);
    buffer_.store(clock, stored, level_width_[next], done == all);
  }
  if (pyramid_.pixel + 1 == pixels(pyramid_)) level_clock_ = clock;
  go_on(pyramid_);
}

}  // namespace vista
