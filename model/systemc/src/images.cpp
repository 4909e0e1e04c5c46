#include "images.h"

#include <fstream>
#include <iterator>

namespace vista {
namespace {

std::vector<uint8_t> whole_images(const std::string& key, const std::string& path, int64_t pixels) {
  if (path.empty()) return {};
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ConfigurationError(key, path + " cannot be read");
  std::vector<uint8_t> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.empty() || static_cast<int64_t>(bytes.size()) % pixels != 0)
    throw ConfigurationError(
        key, path + " holds " + std::to_string(bytes.size()) + " bytes, not whole images of " + std::to_string(pixels));
  return bytes;
}

}  // namespace

Images::Images(const Configuration& c)
    : width_(c.width_px),
      height_(c.height_px),
      disparities_(c.disparities),
      left_file_(whole_images("left_images", c.left_images, c.pixels())),
      right_file_(whole_images("right_images", c.right_images, c.pixels())) {
  if (left_file_.size() != right_file_.size())
    throw ConfigurationError("right_images", "not as many images as left_images");
  if (!left_file_.empty()) return;
  noise_.resize(static_cast<size_t>(c.pixels()));
  for (size_t i = 0; i < noise_.size(); ++i)
    noise_[i] = static_cast<uint8_t>(random_bits(static_cast<uint64_t>(c.seed), i) >> 56);
}

Pair Images::frame(int64_t number) const {
  if (left_file_.empty()) return synthetic(number);
  const int64_t pixels = width_ * height_, first = number % (static_cast<int64_t>(left_file_.size()) / pixels) * pixels;
  const auto part = [&](const std::vector<uint8_t>& file) {
    return std::vector<uint8_t>(file.begin() + first, file.begin() + first + pixels);
  };
  return {part(left_file_), part(right_file_)};
}

// Ground: the disparity grows down the image.
Pair Images::synthetic(int64_t number) const {
  Pair pair{noise_, noise_};
  for (int64_t y = 0; y < height_; ++y) {
    const int64_t row = (y + 3 * number) % height_ * width_, shift = disparities_ / 2 * y / height_;
    for (int64_t x = 0; x < width_; ++x) {
      pair.left[static_cast<size_t>(y * width_ + x)] = noise_[static_cast<size_t>(row + x)];
      pair.right[static_cast<size_t>(y * width_ + x)] = noise_[static_cast<size_t>(row + (x + shift) % width_)];
    }
  }
  return pair;
}

}  // namespace vista
