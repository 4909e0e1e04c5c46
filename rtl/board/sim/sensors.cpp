// SPDX-License-Identifier: Apache-2.0
#include "sensors.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace {

constexpr int kVsync = 6, kJitter = 3;  // pixel clocks
constexpr int kLate = 600;  // more than the board lets a pixel wait, less than a short line at half its clock
constexpr double kApart = 1e-4;  // of the two pixel clocks

constexpr const char* kNames[] = {"none", "missing", "late", "end", "line", "short", "long"};

}  // namespace

const char* name_of(Fault fault) { return kNames[static_cast<int>(fault)]; }

bool take_sensor_option(SensorOptions* o, const std::string& name, const char* value) {
  const double number = std::atof(value);
  if (name == "--pairs")
    o->pairs = value;
  else if (name == "--width")
    o->width = static_cast<int>(number);
  else if (name == "--height")
    o->height = static_cast<int>(number);
  else if (name == "--pixel-mhz")
    o->pixel_mhz = number;
  else if (name == "--rate")
    o->rate_hz = number;
  else if (name == "--line-blanking")
    o->line_blanking = static_cast<int>(number);
  else if (name == "--faults")
    o->faults = number;
  else if (name == "--sensor-seed")
    o->seed = static_cast<unsigned>(number);
  else
    return false;
  return true;
}

Sensors::Sensors(const SensorOptions& options) : options_(options), random_(options.seed) {
  std::ifstream file(options.pairs, std::ios::binary);
  pairs_.assign(std::istreambuf_iterator<char>(file), {});
  images_ = options.width > 0 && options.height > 0
                ? static_cast<int64_t>(pairs_.size()) / (2 * int64_t{options.width} * options.height)
                : 0;
  if (images_ == 0) std::fprintf(stderr, "sensors: %s holds no pair\n", options.pairs.c_str()), std::exit(2);
  sensors_[0].mhz = options.pixel_mhz;
  sensors_[1].mhz = options.pixel_mhz * (1 - kApart);
  sensors_[1].phase = 0.3;
}

void Sensors::board_clock(int64_t clock, double board_mhz) {
  if (static_cast<double>(clock) * options_.rate_hz < static_cast<double>(moment_ + 1) * board_mhz * 1e6) return;
  for (Sensor& sensor : sensors_) {
    if (sensor.sends) std::fprintf(stderr, "sensors: a frame takes longer than the rate allows\n"), std::exit(2);
    sensor.fault = Fault::kNone;
    sensor.moment = moment_;
    sensor.triggered = true;
  }
  if (std::uniform_real_distribution<>(0, 1)(random_) < options_.faults) {
    const int side = static_cast<int>(random_() % 2);
    const auto what = static_cast<Fault>(1 + random_() % (static_cast<int>(Fault::kCount) - 1));
    sensors_[static_cast<size_t>(side)].fault = what;
    faults_.push_back({moment_, side, what});
  }
  ++moment_;
}

int Sensors::clocks_of(int side, double board_mhz) {
  Sensor& sensor = sensors_[static_cast<size_t>(side)];
  int clocks = 0;
  for (sensor.phase += sensor.mhz / board_mhz; sensor.phase >= 1; sensor.phase -= 1) ++clocks;
  return clocks;
}

void Sensors::begin_line(Sensor* sensor) {
  const int jitter = static_cast<int>(random_() % kJitter);
  sensor->blank = options_.line_blanking + jitter - sensor->jitter;
  sensor->jitter = jitter;
  sensor->length = options_.width;
  sensor->column = 0;
  if (sensor->row != sensor->hit) return;
  if (sensor->fault == Fault::kLine) sensor->length = 0;
  if (sensor->fault == Fault::kShort) sensor->length = 1 + static_cast<int>(random_() % (options_.width - 1));
  if (sensor->fault == Fault::kLong) sensor->length = options_.width + 1;
}

// A pulse of VSYNC, then each line behind its blanking. The bus is not quiet between lines.
Wires Sensors::next(int side) {
  Sensor& s = sensors_[static_cast<size_t>(side)];
  Wires wires;
  wires.data = static_cast<uint8_t>(random_());
  if (s.triggered) {
    s.triggered = false;
    s.sends = s.fault != Fault::kMissing;
    s.wait = s.fault == Fault::kLate ? kLate : 0;
    s.vsync = kVsync;
    s.row = 0;
    s.hit = 1 + static_cast<int>(random_() % static_cast<unsigned>(options_.height - 2));
    begin_line(&s);
  }
  if (!s.sends) return wires;
  if (s.wait > 0) {
    --s.wait;
  } else if (s.vsync > 0) {
    --s.vsync;
    wires.vsync = 1;
  } else if (s.blank > 0) {
    --s.blank;
  } else {
    if (s.column < s.length) {
      const int64_t image = 2 * (s.moment % images_) + side, pixels = int64_t{options_.width} * options_.height;
      wires.href = 1;
      if (s.column < options_.width)
        wires.data = pairs_[static_cast<size_t>(image * pixels + int64_t{s.row} * options_.width + s.column)];
    }
    // A line that is short, or is left out, takes its time nevertheless.
    if (++s.column >= std::max(s.length, options_.width)) {
      ++s.row;
      s.sends = s.row < options_.height && !(s.fault == Fault::kEnd && s.row == s.hit);
      begin_line(&s);
    }
  }
  return wires;
}
