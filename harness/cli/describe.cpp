#include <fmt/format.h>

#include <memory>

#include "harness/base/error.h"
#include "harness/cli/verb.h"
#include "harness/method/registry.h"
#include "harness/spec/reading.h"
#include "harness/spec/schema.h"

namespace raystudy::cli {
namespace {

/// A default as it is written in YAML; an empty text would not be seen.
std::string default_text(const ParamSpec& spec) {
  if (spec.type == ParamType::file) return "required";
  const std::string text = label_text(spec.fallback);
  return "default " + (text.empty() ? "''" : text);
}

void describe(const Registry::Entry& entry) {
  const MethodInfo& info = entry.info;
  fmt::print("{} ({})\n  {}\n", info.name, role_name(entry.role), info.summary);
  if (!info.citation.empty()) fmt::print("  source: {}\n", info.citation);
  if (entry.origin != "built in") fmt::print("  from the plugin {}\n", entry.origin);
  const bool makes = entry.role == Role::builder || entry.role == Role::encoder;
  if (!info.accel.empty()) fmt::print("  {}: {}\n", makes ? "makes" : "takes", info.accel);
  for (const MetricValueInfo& value : info.values) {
    fmt::print("  gives: {} [{}]{}{}{}\n", value.name, value.unit, value.axis.empty() ? "" : " over " + value.axis,
               value.summary.empty() ? "" : ": ", value.summary);
  }
  fmt::print("  {}\n", info.params.empty() ? "no parameters" : "parameters");
  for (const ParamSpec& spec : info.params) {
    fmt::print("    {}: {}\n      {}; {}\n", spec.name, spec.summary, expected_text(spec), default_text(spec));
  }
}

int describe_all(const std::vector<std::string>& names) {
  const Registry& registry = Registry::instance();
  std::vector<Diagnostic> problems;
  for (const std::string& name : names) {
    bool found = false;
    std::vector<std::string> known;
    for (const Registry::Entry* entry : registry.entries()) {
      known.push_back(entry->info.name);
      if (entry->info.name != name) continue;
      describe(*entry);
      found = true;
    }
    if (!found) {
      problems.push_back(
          {{}, fmt::format("there is no method '{}'", name), "a name that 'raystudy list' shows", nearest_name(name, known)});
    }
  }
  if (!problems.empty()) throw Error(std::move(problems));
  return exit_ok;
}

const Verb verb{
    "describe", "A method whole: source, what it makes or takes, every parameter with range and default", [](CLI::App& app) {
      auto names = std::make_shared<std::vector<std::string>>();
      auto schema = std::make_shared<bool>(false);
      CLI::Option* name = app.add_option("name", *names, "names of methods");
      app.add_flag("--schema", *schema, "print the JSON Schema of experiments, for editors")->excludes(name);
      return [names, schema]() -> int {
        if (*schema) {
          fmt::print("{}\n", experiment_schema());
          return exit_ok;
        }
        if (names->empty()) {
          throw Error(Diagnostic{{}, "describe names no method", "a name that 'raystudy list' shows, or --schema", {}});
        }
        return describe_all(*names);
      };
    }};

}  // namespace
}  // namespace raystudy::cli
