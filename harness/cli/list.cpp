#include <fmt/format.h>

#include "harness/cli/verb.h"
#include "harness/method/registry.h"

namespace raystudy::cli {
namespace {

int list_methods() {
  const Role* current = nullptr;
  for (const Registry::Entry* entry : Registry::instance().entries()) {
    if (current == nullptr || *current != entry->role) fmt::print("{}s\n", role_name(entry->role));
    current = &entry->role;
    fmt::print("  {:<24} {}{}\n", entry->info.name, entry->info.summary,
               entry->origin == "built in" ? "" : fmt::format(" [{}]", entry->origin));
  }
  return exit_ok;
}

const Verb verb{"list", "Every method, by role, with its one-line summary", [](CLI::App&) { return list_methods; }};

}  // namespace
}  // namespace raystudy::cli
