// What the cameras see: raw files, or noise that moves from frame to frame, shifted between the sides.
#ifndef VISTA_SYSTEM_IMAGES_H
#define VISTA_SYSTEM_IMAGES_H

#include <cstdint>
#include <string>
#include <vector>

#include "configuration.h"

namespace vista {

// splitmix64: small, seedable, the same everywhere, and any draw by its position.
inline uint64_t random_bits(uint64_t seed, uint64_t position) {
  uint64_t z = seed * 0xD1342543DE82EF95u + (position + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
  z = (z ^ z >> 27) * 0x94D049BB133111EBu;
  return z ^ z >> 31;
}

struct Pair {
  std::vector<uint8_t> left, right;
};

class Images {
 public:
  // Throws ConfigurationError for a file that does not hold whole images.
  explicit Images(const Configuration& configuration);
  Pair frame(int64_t number) const;

 private:
  Pair synthetic(int64_t number) const;

  int64_t width_, height_, disparities_;
  std::vector<uint8_t> left_file_, right_file_;
  std::vector<uint8_t> noise_;
};

}  // namespace vista

#endif
