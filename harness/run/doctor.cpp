#include "harness/run/doctor.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/run/memory.h"
#include "harness/run/provenance.h"
#include "harness/scene/catalog.h"
#include "harness/spec/cell_id.h"

namespace raystudy {
namespace {

/// A setting of the machine, its good value, and how it is changed.
Finding setting(const std::string& subject, const std::string& found, const std::string& good, const std::string& advice) {
  if (found.empty()) {
    return {"machine", Health::warn, subject, "not told by the system", "absolute times cannot be trusted to be steady"};
  }
  return {"machine", found == good ? Health::ok : Health::warn, subject, found, found == good ? "" : advice};
}

std::string versions_text(const BuildInfo& build) {
  std::string text;
  for (const auto& [name, version] : build.libraries) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, version);
  return text;
}

bool is_on_path(std::string_view command, std::string_view path) {
  while (!path.empty()) {
    const std::size_t colon = std::min(path.find(':'), path.size());
    const std::filesystem::path file = std::filesystem::path(path.substr(0, colon)) / command;
    if (colon > 0 && access(file.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(file)) return true;
    path.remove_prefix(std::min(colon + 1, path.size()));
  }
  return false;
}

struct Tool {
  std::string_view command;
  std::string_view package;
  std::string_view purpose;
};

constexpr std::array tools{
    Tool{"node", "nodejs", "draws figures"},
    Tool{"npm", "npm", "brings Vega and Vega-Lite, and scenes that npm packages hold"},
    Tool{"rsvg-convert", "librsvg2-bin", "makes PNG of figures"},
    Tool{"apt-get", "apt", "brings scenes that Debian packages hold"},
    Tool{"git", "git", "tells the commit that results come from"},
};

}  // namespace

std::string_view health_name(Health health) {
  constexpr std::array<std::string_view, 3> names{"ok", "warn", "missing"};
  return names.at(static_cast<std::size_t>(health));
}

std::vector<Finding> examine(const Machine& m, const std::vector<BusyProcess>& busy) {
  constexpr double little_memory = 2.0 * 1024 * 1024 * 1024;
  std::vector<Finding> all;
  all.push_back(
      {"machine", Health::ok, "processor", fmt::format("{}, {} logical, microcode {}", m.cpu, m.cores, m.microcode), {}});
  all.push_back({"machine", Health::ok, "kernel", m.kernel, {}});
  all.push_back(setting("governor", m.governor, "performance", "cpupower frequency-set --governor performance"));
  all.push_back(
      setting("turbo", m.turbo, "off",
              "write 1 into /sys/devices/system/cpu/intel_pstate/no_turbo, or 0 into /sys/devices/system/cpu/cpufreq/boost"));
  all.push_back(
      setting("hyper-threading", m.smt, "off", "write off into /sys/devices/system/cpu/smt/control, or use half the threads"));
  all.push_back(
      setting("virtual machine", m.virtual_machine, "no",
              "other guests take time from this one: trust ratios, which are measured interleaved, rather than absolute times"));
  if (m.huge_pages == "always") {
    all.push_back(
        {"machine", Health::warn, "huge pages", m.huge_pages,
         "the kernel merges pages while builds are timed: write madvise into /sys/kernel/mm/transparent_hugepage/enabled"});
  } else {
    all.push_back({"machine", Health::ok, "huge pages", m.huge_pages.empty() ? "none" : m.huge_pages, {}});
  }
  const bool slow_clock = m.clock == "hpet" || m.clock == "acpi_pm";
  all.push_back({"machine", slow_clock ? Health::warn : Health::ok, "clock", m.clock,
                 slow_clock ? "reading this clock takes microseconds: boot with clocksource=tsc" : ""});
  all.push_back({"machine", m.load >= 0.5 ? Health::warn : Health::ok, "load", fmt::format("{:.2f}", m.load),
                 m.load >= 0.5 ? "other work has run within the last minute: end it, or wait" : ""});
  for (const BusyProcess& p : busy) {
    all.push_back({"machine", Health::warn, "busy process",
                   fmt::format("{} ({}): {:.0f} % of a processor", p.name, p.pid, 100 * p.processors),
                   "end it, or wait until it is done"});
  }
  const bool little = m.available_memory < little_memory;
  all.push_back({"machine", little ? Health::warn : Health::ok, "memory",
                 fmt::format("{} free of {}", bytes_text(m.available_memory), bytes_text(m.memory)),
                 little ? "large scenes will not fit: end other programs" : ""});
  all.push_back({"machine", m.swap_used > 0 ? Health::warn : Health::ok, "swap in use", bytes_text(m.swap_used),
                 m.swap_used > 0 ? "pages may be read back while builds are timed: swapoff --all" : ""});
  return all;
}

std::vector<Finding> examine_tools(std::string_view path) {
  std::vector<Finding> all;
  for (const Tool& tool : tools) {
    const bool there = is_on_path(tool.command, path);
    all.push_back({"tools", there ? Health::ok : Health::missing, std::string(tool.command), std::string(tool.purpose),
                   there ? "" : fmt::format("apt-get install {}", tool.package)});
  }
  return all;
}

std::vector<Finding> examine_devices(const std::vector<vulkan::DeviceInfo>& devices) {
  if (devices.empty()) {
    return {{"devices", Health::missing, "Vulkan", "no device",
             "install the driver of the GPU, or mesa-vulkan-drivers for a device on the processor"}};
  }
  std::vector<Finding> all;
  all.reserve(devices.size());
  for (const vulkan::DeviceInfo& d : devices) {
    all.push_back({"devices", d.unfit.empty() ? Health::ok : Health::missing, d.name,
                   fmt::format("{}, {}, {} of memory", d.type, d.driver, bytes_text(static_cast<double>(d.memory))),
                   d.unfit.empty() ? "" : "it lacks " + d.unfit});
  }
  return all;
}

std::vector<Finding> examine_scenes() {
  std::vector<Finding> all;
  for (const std::filesystem::path& folder : scene_folders()) {
    const bool there = std::filesystem::is_directory(folder);
    all.push_back({"scenes", there ? Health::ok : Health::missing, "folder", folder.string(),
                   there ? "" : "is not there: raystudy scene get makes the one in the cache, RAYSTUDY_SCENES names others"});
  }
  try {
    for (const CatalogEntry& entry : read_catalog(catalog_path()).entries) {
      const bool there = is_installed(entry);
      all.push_back({"scenes", there ? Health::ok : Health::missing, entry.name,
                     there ? installed_file(entry)->path : entry.title, there ? "" : not_installed_text(entry)});
    }
  } catch (const Error& error) {
    all.push_back({"scenes", Health::missing, "catalog", error.what(), "mend the catalog"});
  }
  return all;
}

std::vector<Finding> examine_versions() {
  const BuildInfo& build = build_info();
  const bool release = build.build_type == "Release" && MemoryLimit::is_enforced();
  std::vector<Finding> all;
  all.push_back({"versions", build.dirty == "no" ? Health::ok : Health::warn, "commit",
                 fmt::format("{}{}", build.commit, build.dirty == "yes" ? ", changed since" : ""),
                 build.dirty == "no" ? "" : "results say so; commit before measuring what is to be published"});
  all.push_back({"versions", Health::ok, "code hash", std::string(code_hash()), {}});
  all.push_back({"versions", release ? Health::ok : Health::warn, "build", build.build_type,
                 release ? "" : "times of this build are no one's: cmake --preset release"});
  all.push_back({"versions", Health::ok, "compiler", fmt::format("{}, {}", build.compiler, build.flags), {}});
  all.push_back({"versions", Health::ok, "libraries", versions_text(build), {}});
  return all;
}

std::string findings_text(const std::vector<Finding>& findings) {
  std::size_t widest = 0;
  for (const Finding& f : findings) widest = std::max(widest, f.subject.size());
  std::string text;
  std::string group;
  for (const Finding& f : findings) {
    if (f.group != group) text += fmt::format("{}{}\n", group.empty() ? "" : "\n", f.group);
    group = f.group;
    text += fmt::format("  {:<7}  {:<{}}  {}\n", health_name(f.health), f.subject, widest, f.found);
    if (!f.advice.empty()) text += fmt::format("  {:<7}  {:<{}}  → {}\n", "", "", widest, f.advice);
  }
  return text;
}

std::string findings_json(const std::vector<Finding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    list.push_back({{"group", f.group},
                    {"health", health_name(f.health)},
                    {"subject", f.subject},
                    {"found", f.found},
                    {"advice", f.advice}});
  }
  return list.dump(2) + '\n';
}

}  // namespace raystudy
