#include "words.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

namespace vista {
namespace {

constexpr size_t kAlignment = 64;

}  // namespace

WordEngine::WordEngine(const vista_engine_params& parameters, int width, int height)
    : parameters_(parameters),
      width_(width),
      height_(height),
      scratch_bytes_(vista_engine_scratch_bytes(&parameters, width, height, 1)),
      disparity_(static_cast<size_t>(width) * static_cast<size_t>(height)),
      smin_(disparity_.size()) {
  scratch_.resize(scratch_bytes_ + kAlignment);
}

std::vector<uint32_t> WordEngine::compute(const uint8_t* left, const uint8_t* right) {
  void* scratch = scratch_.data();
  size_t room = scratch_.size();
  std::align(kAlignment, scratch_bytes_, scratch, room);
  const vista_engine_images images = {left, right, width_, height_, width_, width_};
  const vista_engine_output output = {disparity_.data(), smin_.data(), width_, width_, nullptr, 0};
  const vista_engine_status status = vista_engine_compute(&parameters_, &images, &output, scratch, scratch_bytes_);
  if (status != VISTA_ENGINE_OK) throw std::runtime_error(vista_engine_status_text(status));
  std::vector<uint32_t> words(disparity_.size());
  for (size_t i = 0; i < words.size(); ++i)
    words[i] = std::min<uint32_t>(smin_[i], 0xFFFF) << 16 | static_cast<uint16_t>(disparity_[i]);
  return words;
}

}  // namespace vista
