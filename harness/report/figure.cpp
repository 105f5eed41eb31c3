#include "harness/report/figure.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/atomic_file.h"
#include "harness/report/vega.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

void draw_plot(const FigureSpec& figure, const Report& report, const fs::path& folder, FigureOutcome& outcome) {
  const std::string spec = figure_spec(figure, report, outcome.gaps);
  if (spec.empty()) {
    outcome.failed = true;
    return;
  }
  const fs::path file = folder / (figure.name + ".vl.json");
  write_file_atomically(file, spec);
  outcome.files.push_back(file);
  render_vega(file);
  outcome.files.push_back(folder / (figure.name + ".svg"));
  outcome.files.push_back(folder / (figure.name + ".png"));
}

}  // namespace

std::vector<FigureOutcome> write_figures(const Report& report, const fs::path& folder, const std::string& name) {
  const std::vector<FigureSpec>& figures = report.plan().figures;
  if (!name.empty() && std::none_of(figures.begin(), figures.end(), [&](const FigureSpec& f) { return f.name == name; })) {
    std::vector<std::string> names;
    names.reserve(figures.size());
    for (const FigureSpec& f : figures) names.push_back(f.name);
    throw Error(Diagnostic{{report.plan().file, 0, 0},
                           fmt::format("there is no figure '{}'", name),
                           names.empty() ? "an experiment with figures" : fmt::format("one of {}", fmt::join(names, ", ")),
                           nearest_name(name, names)});
  }
  if (!figures.empty()) require_writable_folder(folder);
  std::vector<FigureOutcome> outcomes;
  for (const FigureSpec& figure : figures) {
    if (!name.empty() && figure.name != name) continue;
    FigureOutcome& outcome = outcomes.emplace_back();
    outcome.name = figure.name;
    try {
      if (figure.kind == "heat-map" || figure.kind == "render" || figure.kind == "film-strip") {
        draw_pictures(figure, report.plan(), folder, outcome);
      } else {
        draw_plot(figure, report, folder, outcome);
      }
    } catch (const Error& error) {
      outcome.failed = true;
      outcome.gaps.emplace_back(error.what());
    }
  }
  return outcomes;
}

std::string outcome_text(const FigureOutcome& outcome) {
  std::string text = fmt::format("figure {}:", outcome.name);
  if (outcome.failed) text += " not drawn";
  for (const fs::path& file : outcome.files) text += ' ' + file.string();
  text += '\n';
  for (const std::string& remark : outcome.remarks) text += fmt::format("  {}\n", remark);
  for (const std::string& gap : outcome.gaps) text += fmt::format("  not shown: {}\n", gap);
  return text;
}

}  // namespace raystudy
