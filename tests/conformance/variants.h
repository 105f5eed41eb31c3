#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "harness/method/registry.h"
#include "harness/vulkan/device.h"

namespace raystudy::test {

/// A method with its defaults, or with one choice or switch set otherwise.
struct Variant {
  std::string label;  ///< letters, digits and underscores, as test names may have them
  MethodRef ref;
  std::string accel;
  bool on_device = false;
};

/// All of a role that need no file, in the order of names; with `defaults_only` one for each method
/// that works on the processor.
inline std::vector<Variant> variants(Role role, bool defaults_only = false) {
  const Registry& registry = Registry::instance();
  std::vector<Variant> all;
  const auto add = [&](const Registry::Entry& entry, const std::string& suffix, auto changes) {
    std::string label = entry.info.name + suffix;
    std::replace_if(
        label.begin(), label.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
    all.push_back({label, registry.ref(role, entry.info.name, std::move(changes)), entry.info.accel, entry.info.on_device});
  };
  using Changes = std::map<std::string, ParamValue, std::less<>>;
  for (const Registry::Entry* entry : registry.entries()) {
    if (entry->role != role || entry->info.needs_file()) continue;
    if (defaults_only && entry->info.on_device) continue;
    add(*entry, "", Changes{});
    if (defaults_only) continue;
    for (const ParamSpec& param : entry->info.params) {
      if (param.type == ParamType::boolean)
        add(*entry, "__" + param.name, Changes{{param.name, !std::get<bool>(param.fallback)}});
      if (param.type != ParamType::choice) continue;
      for (const std::string& choice : param.choices) {
        if (choice != std::get<std::string>(param.fallback))
          add(*entry, "__" + param.name + "_" + choice, Changes{{param.name, choice}});
      }
    }
  }
  return all;
}

/// Why a method cannot be tested on this machine; empty where it can.
inline std::string why_not_here(const Variant& variant) {
  return variant.on_device && vulkan::list_devices().empty() ? "there is no Vulkan device on this machine" : "";
}

inline std::string variant_name(const testing::TestParamInfo<Variant>& info) { return info.param.label; }
inline void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.label; }

}  // namespace raystudy::test
