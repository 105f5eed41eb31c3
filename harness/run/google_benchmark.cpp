#include "harness/run/google_benchmark.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "harness/base/atomic_file.h"
#include "harness/run/result.h"
#include "harness/spec/cell_id.h"

namespace raystudy {
namespace {

using nlohmann::ordered_json;

std::string text_of(const CellResult& result, const std::string& name) {
  const auto found = result.provenance.find(name);
  return found == result.provenance.end() ? std::string{} : found->second;
}

ordered_json context_of(const CellResult& result) {
  ordered_json context{{"date", text_of(result, "date")}, {"executable", "raystudy"}, {"library_build_type", "release"}};
  for (const auto& [name, text] : result.provenance) context["raystudy_" + name] = text;
  return context;
}

void add_entries(ordered_json& list, const CellResult& result, std::size_t family) {
  const bool traced = !result.workload.empty();
  const std::string name = traced ? result.method + '/' + result.tracer + '/' + result.workload : result.method + "/build";
  const auto& real = result.values.at(traced ? "trace_time" : "total_time").samples;
  const auto& cpu = result.values.at("cpu_time").samples;
  const auto& iterations = result.values.at("iterations").samples;
  for (std::size_t i = 0; i < real.size(); ++i) {
    ordered_json entry{{"name", name},
                       {"family_index", family},
                       {"per_family_instance_index", 0},
                       {"run_name", name},
                       {"run_type", "iteration"},
                       {"repetitions", real.size()},
                       {"repetition_index", i},
                       {"threads", 1},
                       {"iterations", static_cast<std::int64_t>(iterations[i])},
                       {"real_time", 1e3 * real[i]},
                       {"cpu_time", 1e3 * cpu[i]},
                       {"time_unit", "ms"}};
    for (const auto& [key, value] : result.values) {
      if (value.value_class == ValueClass::exact) entry[key] = value.samples.front();
    }
    list.push_back(std::move(entry));
  }
}

std::string file_name(std::string label) {
  std::replace(label.begin(), label.end(), '/', '-');
  return label + ".json";
}

}  // namespace

void write_google_benchmark(const Plan& plan, std::size_t scene, const std::filesystem::path& folder) {
  ordered_json document{{"context", ordered_json::object()}, {"benchmarks", ordered_json::array()}};
  std::size_t family = 0;
  for (const Cell& cell : plan.cells) {
    const std::filesystem::path file = result_file(folder, cell_id(plan, cell));
    if (cell.scene != scene || !std::filesystem::exists(file)) continue;
    const CellResult result = read_result(file);
    if (result.status != CellStatus::done) continue;
    document["context"] = context_of(result);
    add_entries(document["benchmarks"], result, family++);
  }
  if (family == 0) return;
  // Nothing that the results do not say already.
  write_file_atomically(folder / "google-benchmark" / file_name(plan.scenes[scene].label), document.dump(2) + '\n', Durable::no);
}

}  // namespace raystudy
