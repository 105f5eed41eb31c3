#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "harness/run/machine.h"
#include "harness/vulkan/device.h"

namespace raystudy {

/// ok: as it should be. warn: timings suffer. missing: something cannot be done without it.
enum class Health : unsigned char { ok, warn, missing };
[[nodiscard]] std::string_view health_name(Health health);

/// One thing that `raystudy doctor` looked at.
struct Finding {
  std::string group;  ///< machine, tools, devices, scenes, versions
  Health health = Health::ok;
  std::string subject;
  std::string found;
  std::string advice;  ///< what to do; empty where all is well
};

/// What of the machine would disturb a timing.
[[nodiscard]] std::vector<Finding> examine(const Machine& machine, const std::vector<BusyProcess>& busy);
/// Programs that figures and scenes need, looked for on `path` (as PATH is written).
[[nodiscard]] std::vector<Finding> examine_tools(std::string_view path);
/// The Vulkan devices that are there.
[[nodiscard]] std::vector<Finding> examine_devices(const std::vector<vulkan::DeviceInfo>& devices);
/// The scene folders, and which scenes of the catalog are at hand.
[[nodiscard]] std::vector<Finding> examine_scenes();
/// This Raystudy and the libraries it was built with.
[[nodiscard]] std::vector<Finding> examine_versions();

/// Lines for people, group by group; and a JSON array of objects with Finding's members.
[[nodiscard]] std::string findings_text(const std::vector<Finding>& findings);
[[nodiscard]] std::string findings_json(const std::vector<Finding>& findings);

}  // namespace raystudy
