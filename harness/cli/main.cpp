#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <map>
#include <optional>
#include <utility>

#include "harness/base/error.h"
#include "harness/cli/verb.h"
#include "harness/method/registry.h"

namespace raystudy::cli {
namespace {

struct VerbEntry {
  std::string summary;
  VerbSetup setup;
};

std::map<std::string, VerbEntry>& verbs() {
  static std::map<std::string, VerbEntry> all;
  return all;
}

/// The nearest verb, where the first argument is a misspelt one.
std::string verb_hint(int argc, char** argv) {
  std::vector<std::string> names;
  for (const auto& [name, entry] : verbs()) names.push_back(name);
  if (argc < 2 || argv[1][0] == '-' || verbs().contains(argv[1])) return {};
  return Diagnostic{{},
                    fmt::format("there is no command '{}'", argv[1]),
                    fmt::format("one of {}", fmt::join(names, ", ")),
                    nearest_name(argv[1], names)}
      .text();
}

int run(int argc, char** argv) {
  CLI::App app{"Raystudy: a research harness for ray-tracing acceleration structures", "raystudy"};
  app.require_subcommand(1);
  app.set_version_flag("--version", RAYSTUDY_VERSION);
  std::map<CLI::App*, std::function<int()>> actions;
  for (const auto& [name, entry] : verbs()) {
    CLI::App* sub = app.add_subcommand(name, entry.summary);
    actions[sub] = entry.setup(*sub);
  }
  if (const std::string hint = verb_hint(argc, argv); !hint.empty()) {
    fmt::print(stderr, "raystudy: {}\n", hint);
    return exit_bad_input;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_ok : exit_bad_input;
  }
  Registry::instance().require_no_conflicts();
  if (const char* plugins = std::getenv("RAYSTUDY_PLUGINS")) load_plugins(plugins);
  return actions.at(app.get_subcommands().front())();
}

}  // namespace

Verb::Verb(std::string name, std::string summary, VerbSetup setup) {
  verbs()[std::move(name)] = {std::move(summary), std::move(setup)};
}

}  // namespace raystudy::cli

int main(int argc, char** argv) {
  try {
    return raystudy::cli::run(argc, argv);
  } catch (const raystudy::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return raystudy::cli::exit_bad_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "raystudy: internal error: {}\n", error.what());
    return raystudy::cli::exit_internal;
  }
}
