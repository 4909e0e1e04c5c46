#include "engine.h"

namespace vista {

Engine::Engine(const sc_core::sc_module_name& name, const clocks::Build& build, const std::vector<clocks::Size>& levels)
    : sc_module(name), clocks_(build), levels_(levels) {
  for (const clocks::Size& size : levels_)
    level_ends_.push_back(pixels_per_frame_ += static_cast<int64_t>(size.width) * size.height);
  clocks_.set_size(levels_[0]);
  SC_HAS_PROCESS(Engine);
  SC_THREAD(run);
}

FrameClocks& Engine::of_pixel() {
  if (frame_in_ == frames_.size()) frames_.emplace_back();
  return frames_[frame_in_];
}

void Engine::run() {
  for (;;) {
    const bool pixel_valid = pixels->pixel_valid(clock_);
    if (!pixel_valid && clocks_.quiet()) {
      const int64_t next = pixels->next_pixel(clock_);
      if (next > clock_) {
        if (pixels_taken_ > 0) of_pixel().starved += next - clock_;
        clock_ = next;
        continue;
      }
    }
    step(pixel_valid);
    ++clock_;
    ++clocks_busy_;
  }
}

void Engine::step(bool pixel_valid) {
  const bool word_valid = clocks_.word_valid();
  const bool word_ready = word_valid && words->word_ready(clock_);
  const bool pixel_taken = pixel_valid && clocks_.pixel_ready();
  if (pixel_taken) {
    FrameClocks& frame = of_pixel();
    if (pixels_taken_ == 0) frame.first_pixel = clock_;
    pixels->pixel_taken(clock_);
    if (++pixels_taken_ == level_ends_[level_in_]) {
      level_in_ = (level_in_ + 1) % levels_.size();
      clocks_.set_size(levels_[level_in_]);
    }
    if (pixels_taken_ == pixels_per_frame_) {
      frame.last_pixel = clock_;
      pixels_taken_ = 0;
      ++frame_in_;
    }
  } else if (pixel_valid) {
    ++of_pixel().stalls_in;
  } else if (pixels_taken_ > 0) {
    ++of_pixel().starved;
  }
  if (word_valid) {
    FrameClocks& frame = frames_[frame_out_];
    if (!word_ready) {
      ++frame.stalls_out;
    } else {
      if (words_taken_ == 0) frame.first_word = clock_;
      if (++words_taken_ == pixels_per_frame_) {
        frame.last_word = clock_;
        words_taken_ = 0;
        ++frame_out_;
      }
      words->word_taken(clock_);
    }
  }
  clocks_.edge(pixel_valid, word_ready);
}

}  // namespace vista
