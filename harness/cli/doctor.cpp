#include "harness/run/doctor.h"

#include <fmt/format.h>

#include <cstdlib>
#include <iterator>
#include <memory>

#include "harness/cli/verb.h"
#include "harness/vulkan/device.h"

namespace raystudy::cli {
namespace {

int examine_all(bool json) {
  constexpr double watched_seconds = 0.3;
  std::vector<Finding> all = examine(read_machine(), busy_processes(watched_seconds));
  const char* path = std::getenv("PATH");
  for (std::vector<Finding> more : {examine_tools(path != nullptr ? path : ""), examine_devices(vulkan::list_devices()),
                                    examine_scenes(), examine_versions()}) {
    std::move(more.begin(), more.end(), std::back_inserter(all));
  }
  fmt::print("{}", json ? findings_json(all) : findings_text(all));
  return exit_ok;
}

const Verb verb{"doctor", "What would disturb a timing here, what is missing, and which versions are in use", [](CLI::App& app) {
                  auto json = std::make_shared<bool>(false);
                  app.add_flag("--json", *json, "for programs to read");
                  return [json] { return examine_all(*json); };
                }};

}  // namespace
}  // namespace raystudy::cli
