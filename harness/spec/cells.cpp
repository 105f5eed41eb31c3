#include "harness/spec/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "harness/spec/reading.h"

namespace raystudy {
namespace {

bool part_matches(std::string_view glob, std::string_view text) {
  std::size_t g = 0;
  std::size_t t = 0;
  std::size_t star = std::string_view::npos;
  std::size_t star_text = 0;
  while (t < text.size()) {
    if (g < glob.size() && glob[g] == '*') {
      star = g++;
      star_text = t;
    } else if (g < glob.size() && (glob[g] == '?' || glob[g] == text[t])) {
      ++g;
      ++t;
    } else if (star != std::string_view::npos) {
      g = star + 1;
      t = ++star_text;
    } else {
      return false;
    }
  }
  return glob.find_first_not_of('*', g) == std::string_view::npos;
}

std::string_view take_part(std::string_view& rest) {
  const std::size_t slash = rest.find('/');
  const std::string_view part = rest.substr(0, slash);
  rest = slash == std::string_view::npos ? std::string_view{} : rest.substr(slash + 1);
  return part;
}

}  // namespace

std::vector<Cell> expand_cells(const Plan& plan) {
  std::vector<Cell> cells;
  for (std::size_t scene = 0; scene < plan.scenes.size(); ++scene) {
    for (std::size_t pipeline = 0; pipeline < plan.pipelines.size(); ++pipeline) {
      cells.push_back({scene, pipeline, std::nullopt, std::nullopt});
      for (const std::string& label : plan.pipelines[pipeline].tracers) {
        const std::optional<std::size_t> tracer = index_of(plan.tracers, label);
        for (std::size_t workload = 0; workload < plan.workloads.size(); ++workload) {
          cells.push_back({scene, pipeline, tracer, workload});
        }
      }
    }
  }
  return cells;
}

std::string cell_path(const Plan& plan, const Cell& cell) {
  std::string path = plan.scenes.at(cell.scene).label + "/" + plan.pipelines.at(cell.pipeline).label;
  if (cell.tracer) path += "/" + plan.tracers.at(*cell.tracer).label;
  if (cell.workload) path += "/" + plan.workloads.at(*cell.workload).label;
  return path;
}

bool path_matches(std::string_view glob, std::string_view path) {
  while (!glob.empty()) {
    const std::string_view wanted = take_part(glob);
    if (!part_matches(wanted, take_part(path))) return false;
  }
  return true;
}

Shard read_shard(std::string_view text) {
  Shard shard;
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto whole = [](std::string_view part, int& number) {
    const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    return error == std::errc{} && stop == part.data() + part.size();
  };
  if (slash == text.size() || !whole(text.substr(0, slash), shard.index) || !whole(text.substr(slash + 1), shard.count) ||
      shard.index < 1 || shard.index > shard.count) {
    throw Error(Diagnostic{{}, fmt::format("--shard is '{}'", text), "i/n with 1 <= i <= n, such as 1/4", {}});
  }
  return shard;
}

void select_cells(Plan& plan, std::string_view only, Shard shard) {
  if (!only.empty()) {
    std::string example;
    if (!plan.cells.empty()) example = cell_path(plan, plan.cells.back());
    std::erase_if(plan.cells, [&](const Cell& cell) { return !path_matches(only, cell_path(plan, cell)); });
    if (plan.cells.empty()) {
      throw Error(Diagnostic{{plan.file, 0, 0},
                             fmt::format("--only '{}' names no cell", only),
                             fmt::format("scene/method/tracer/workload, where * stands for anything, such as '{}'", example),
                             {}});
    }
  }
  std::erase_if(plan.cells, [&shard](const Cell& cell) {
    return cell.scene % static_cast<std::size_t>(shard.count) != static_cast<std::size_t>(shard.index - 1);
  });
}

}  // namespace raystudy
