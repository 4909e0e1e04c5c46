// The words of a frame, by model/c: {Smin[15:0], disparity[15:0]}, Smin saturated, as the RTL sends them.
#ifndef VISTA_SYSTEM_WORDS_H
#define VISTA_SYSTEM_WORDS_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "configuration.h"

namespace vista {

class WordEngine {
 public:
  WordEngine(const vista_engine_params& parameters, int width, int height);
  // Both images row after row; returns width * height words. Throws std::runtime_error with the status text.
  std::vector<uint32_t> compute(const uint8_t* left, const uint8_t* right);

 private:
  vista_engine_params parameters_;
  int width_, height_;
  std::vector<uint8_t> scratch_;
  size_t scratch_bytes_;
  std::vector<int16_t> disparity_;
  std::vector<uint32_t> smin_;
};

}  // namespace vista

#endif
