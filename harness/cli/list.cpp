#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>

#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/base/yaml.h"
#include "harness/cli/verb.h"
#include "harness/method/registry.h"
#include "harness/scene/catalog.h"
#include "harness/scene/procedural.h"
#include "harness/spec/figure_kinds.h"
#include "harness/spec/quantity.h"
#include "harness/vulkan/device.h"

namespace raystudy::cli {
namespace {

void print_line(std::string_view name, std::string_view text) { fmt::print("  {:<24} {}\n", name, text); }

void list_methods(std::optional<Role> only) {
  const Role* current = nullptr;
  for (const Registry::Entry* entry : Registry::instance().entries()) {
    if (only && entry->role != *only) continue;
    if (current == nullptr || *current != entry->role) fmt::print("{}s\n", role_name(entry->role));
    current = &entry->role;
    print_line(entry->info.name, entry->info.summary + (entry->origin == "built in" ? "" : fmt::format(" [{}]", entry->origin)));
  }
}

void list_scenes() {
  fmt::print("made to measure (in an experiment: 'NAME: {{triangles: N, seed: S}}')\n");
  for (const ProceduralInfo& info : procedural_scenes()) print_line(info.name, info.summary);
  fmt::print("catalog\n");
  for (const CatalogEntry& entry : read_catalog(catalog_path()).entries) {
    const std::string state = is_installed(entry) ? "at hand" : "not installed";
    const std::string size = entry.triangles > 0 ? fmt::format("{} triangles", entry.triangles) : "size not stated";
    print_line(entry.name, fmt::format("{}; {}, {}", entry.title, size, state));
  }
}

/// The YAML files of a folder with their titles.
void list_experiments(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
  }
  if (error) {
    throw Error(Diagnostic{{folder.string(), 0, 0}, "cannot be listed: " + error.message(), "a folder of experiments", {}});
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    std::vector<Diagnostic> problems;
    std::string title;
    try {
      const auto root = read_yaml(file, problems);
      if (const YamlNode* node = root->find("title")) title = node->text;
    } catch (const Error&) {
      title = "cannot be read: see 'raystudy check'";
    }
    fmt::print("  {:<44} {}\n", file, title);
  }
}

void list_quantities() {
  const auto print = [](const Quantity& q) {
    print_line(q.name, fmt::format("[{}] {}{}", q.unit, q.summary, q.axis.empty() ? "" : fmt::format(", over {}", q.axis)));
  };
  for (const bool traced : {false, true}) {
    fmt::print("{}\n", traced ? "of rays through a structure" : "of a build");
    for (const Quantity& quantity : harness_quantities()) {
      if (quantity.traced == traced) print(quantity);
    }
    if (traced) continue;
    for (const Quantity& quantity : build_part_quantities()) print(quantity);
    for (const std::string& metric : Registry::instance().names(Role::metric)) {
      for (const Quantity& quantity : metric_quantities(metric)) print(quantity);
    }
  }
}

void list_figures() {
  for (const FigureKind& kind : figure_kinds()) {
    print_line(kind.name, kind.summary);
    for (const ParamSpec& option : kind.options) {
      print_line("", fmt::format("{}: {}; {}", option.name, option.summary, expected_text(option)));
    }
  }
}

void list_devices() {
  const std::vector<vulkan::DeviceInfo> devices = vulkan::list_devices();
  if (devices.empty()) fmt::print("there is no Vulkan device on this machine\n");
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const vulkan::DeviceInfo& d = devices[i];
    fmt::print("  {}  {}\n     {}, {}, {} of memory, subgroups of {}{}\n", i, d.name, d.type, d.driver,
               bytes_text(static_cast<double>(d.memory)), d.subgroup_size, d.unfit.empty() ? "" : "; lacks " + d.unfit);
  }
}

int list(const std::string& what, const std::string& folder) {
  constexpr std::array roles{Role::builder, Role::optimizer, Role::encoder, Role::heuristic,
                             Role::tracer,  Role::workload,  Role::metric,  Role::updater};
  std::vector<std::string> known{"methods", "scenes", "experiments", "quantities", "figures", "devices"};
  if (what == "methods") {
    list_methods(std::nullopt);
  } else if (what == "scenes") {
    list_scenes();
  } else if (what == "experiments") {
    list_experiments(folder);
  } else if (what == "quantities") {
    list_quantities();
  } else if (what == "figures") {
    list_figures();
  } else if (what == "devices") {
    list_devices();
  } else {
    for (const Role role : roles) {
      known.push_back(std::string(role_name(role)) + "s");
      if (what != known.back()) continue;
      list_methods(role);
      return exit_ok;
    }
    throw Error(Diagnostic{{},
                           fmt::format("there is nothing called '{}' to list", what),
                           fmt::format("one of {}", fmt::join(known, ", ")),
                           nearest_name(what, known)});
  }
  return exit_ok;
}

const Verb verb{"list", "What there is: methods (by role), scenes, experiments, quantities, figures, devices", [](CLI::App& app) {
                  auto what = std::make_shared<std::string>("methods");
                  auto folder = std::make_shared<std::string>("experiments");
                  app.add_option("what", *what, "methods, builders, ..., scenes, experiments, quantities, figures or devices")
                      ->capture_default_str();
                  app.add_option("--folder", *folder, "where experiments are looked for")->capture_default_str();
                  return [what, folder] { return list(*what, *folder); };
                }};

}  // namespace
}  // namespace raystudy::cli
