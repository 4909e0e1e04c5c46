// SPDX-License-Identifier: Apache-2.0
// Two sensors with parallel ports (DVP) before the simulated board: blanking, jitter of their lines, clocks of their own,
// and what goes wrong with sensors. They wait for nobody. Moment m shows pair m of a file, again from the first on.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

struct SensorOptions {
  std::string pairs;  // file: left and right image of each pair, raw; empty: no sensors
  int width = 0, height = 0;
  double pixel_mhz = 40, rate_hz = 90;
  int line_blanking = 160;  // pixel clocks
  double faults = 0;  // share of moments in which something happens to one camera's frame
  unsigned seed = 1;
};

// Takes over an option of this name; false: there is none.
bool take_sensor_option(SensorOptions* options, const std::string& name, const char* value);

enum class Fault { kNone, kMissing, kLate, kEnd, kLine, kShort, kLong, kCount };
const char* name_of(Fault fault);

struct FaultOf {
  int64_t moment;
  int side;
  Fault what;
};

// What a sensor drives in a clock of its own.
struct Wires {
  uint8_t vsync = 0, href = 0, data = 0;
};

class Sensors {
 public:
  explicit Sensors(const SensorOptions& options);

  // One clock of the board: triggers both sensors when it is time.
  void board_clock(int64_t clock, double board_mhz);
  // Clocks of a sensor that begin in a clock of the board.
  int clocks_of(int side, double board_mhz);
  Wires next(int side);

  int64_t moments() const { return moment_; }
  const std::vector<FaultOf>& faults() const { return faults_; }

 private:
  struct Sensor {
    double phase = 0, mhz = 0;
    bool sends = false, triggered = false;
    Fault fault = Fault::kNone;
    int64_t moment = 0;
    int wait = 0, vsync = 0, row = 0, column = 0, blank = 0, length = 0, hit = 0, jitter = 0;
  };
  void begin_line(Sensor* sensor);

  SensorOptions options_;
  std::vector<uint8_t> pairs_;
  int64_t images_, moment_ = 0;
  std::mt19937 random_;
  std::array<Sensor, 2> sensors_;
  std::vector<FaultOf> faults_;
};
