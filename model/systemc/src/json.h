// JSON values as text.
#ifndef VISTA_SYSTEM_JSON_H
#define VISTA_SYSTEM_JSON_H

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace vista {

inline std::string json_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    char escaped[8];
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
      quoted += escaped;
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

inline std::string json_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

// Times that a frame never came to are below 0.
inline std::string json_count_or_null(int64_t value) { return value < 0 ? "null" : std::to_string(value); }

// A measured series in short.
inline std::string json_series(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  const size_t n = ms.size();
  const double median = (ms[(n - 1) / 2] + ms[n / 2]) / 2;
  const double mean = std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(n);
  return "{\"samples\": " + std::to_string(n) + ", \"median_ms\": " + json_number(median) +
         ", \"mean_ms\": " + json_number(mean) + "}";
}

using JsonItems = std::vector<std::pair<std::string, std::string>>;

inline std::string json_object(const JsonItems& items) {
  std::string text = "{";
  for (const auto& [name, value] : items) text += (text.size() > 1 ? ", " : "") + json_text(name) + ": " + value;
  return text + "}";
}

inline std::string json_list(const std::vector<std::string>& values, const char* separator = ", ") {
  std::string text = "[";
  for (const auto& value : values) text += (text.size() > 1 ? separator : "") + value;
  return text + "]";
}

}  // namespace vista

#endif
