#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace raystudy {

/// What a method that works on a device of its own (a GPU) measured there.
struct DeviceTimes {
  struct Part {
    std::string name;
    double seconds = 0;
  };
  /// A level of a tree that is built breadth first.
  struct Level {
    double seconds = 0;
    double active = 0;  ///< nodes that were to be split
  };

  std::optional<double> seconds;  ///< by the device's clock; counts as the time of the work in place of the wall clock's
  double upload = 0;              ///< seconds by the wall clock, not part of `seconds`
  double download = 0;            ///< the same
  std::vector<Part> parts;        ///< of `seconds`, in order
  std::vector<Level> levels;      ///< from the root on
  std::size_t peak_bytes = 0;     ///< most memory of the device that was in use

  /// Work that is done after this: times and parts are added, the levels are the later ones.
  void add(const DeviceTimes& later) {
    if (later.seconds) seconds = seconds.value_or(0) + *later.seconds;
    upload += later.upload;
    download += later.download;
    for (const Part& part : later.parts) {
      const auto known = std::find_if(parts.begin(), parts.end(), [&part](const Part& p) { return p.name == part.name; });
      if (known == parts.end()) {
        parts.push_back(part);
      } else {
        known->seconds += part.seconds;
      }
    }
    if (!later.levels.empty()) levels = later.levels;
    peak_bytes = std::max(peak_bytes, later.peak_bytes);
  }
};

}  // namespace raystudy
