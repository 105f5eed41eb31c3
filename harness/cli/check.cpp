#include <fmt/format.h>

#include <memory>
#include <optional>

#include "harness/cli/verb.h"
#include "harness/report/table.h"
#include "harness/spec/plan.h"

namespace raystudy::cli {
namespace {

/// What only the report can know: whether the published values that tables name exist and have the columns' units.
void check_published(const std::string& file) {
  const Plan plan = read_plan(file, Scale::paper);
  const std::optional<Published> published = published_of(plan);
  check_tables(plan, published ? &*published : nullptr);
}

const Verb verb{"check", "Read an experiment at every scale and show everything that is wrong with it", [](CLI::App& app) {
                  auto files = std::make_shared<std::vector<std::string>>();
                  app.add_option("experiment", *files, "YAML files")->required();
                  return [files]() -> int {
                    int code = exit_ok;
                    for (const std::string& file : *files) {
                      try {
                        check_plan(file);
                        check_published(file);
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
