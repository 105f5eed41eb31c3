#include <fmt/format.h>

#include <memory>

#include "harness/cli/verb.h"
#include "harness/spec/plan.h"

namespace raystudy::cli {
namespace {

const Verb verb{"check", "Read an experiment at every scale and show everything that is wrong with it", [](CLI::App& app) {
                  auto files = std::make_shared<std::vector<std::string>>();
                  app.add_option("experiment", *files, "YAML files")->required();
                  return [files]() -> int {
                    int code = exit_ok;
                    for (const std::string& file : *files) {
                      try {
                        check_plan(file);
                        fmt::print("{}: OK\n", file);
                      } catch (const Error& error) {
                        fmt::print(stderr, "{}\n", error.what());
                        code = exit_bad_input;
                      }
                    }
                    return code;
                  };
                }};

}  // namespace
}  // namespace raystudy::cli
