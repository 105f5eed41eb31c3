#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "harness/spec/figure_kinds.h"
#include "harness/spec/lookup.h"
#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

class FigureReader {
 public:
  FigureReader(Reading& reading, const Plan& plan) : reading_(reading), plan_(plan), lookup_(reading, plan) {}

  FigureSpec read(const YamlEntry& entry) {
    FigureSpec figure;
    figure.name = entry.key;
    figure.where = entry.where;
    Fields fields(reading_, *entry.value, fmt::format("figure '{}'", entry.key));
    figure.caption = fields.text("caption", entry.key);
    std::vector<std::string> kinds;
    for (const FigureKind& kind : figure_kinds()) kinds.push_back(kind.name);
    const YamlNode* kind_node = fields.require("kind", fmt::format("one of {}", fmt::join(kinds, ", ")));
    if (kind_node == nullptr) return figure;
    figure.kind = fields.text("kind");
    const FigureKind* kind = find_figure_kind(figure.kind);
    if (kind == nullptr) {
      reading_.report_unknown(kind_node->where, fmt::format("there is no kind of figure '{}'", figure.kind), figure.kind, kinds);
      return figure;
    }
    figure.scenes = labels(fields, "scenes", plan_.scenes, "scene");
    if (kind->drawn_per_method) {
      figure.methods = labels(fields, "methods", plan_.pipelines, "method");
      if (kind->takes_own_tracers && fields.find("methods") == nullptr) {
        std::erase_if(figure.methods, [this](const std::string& method) {
          return plan_.pipelines[*index_of(plan_.pipelines, method)].tracers.empty();
        });
      }
      if (kind->styled) read_styles(fields, figure);
    }
    for (const ParamSpec& option : kind->options) figure.options[option.name] = label_text(fields.value(option));
    bool traced = kind->traced;
    if (figure.kind == "film-strip" && !plan_.animation) {
      reading_.report(kind_node->where,
                      fmt::format("figure '{}' is a film strip, and the experiment plays no animation", figure.name),
                      "'animation: {frames: 50}' in the experiment");
    }
    if (figure.kind == "line") traced = check_line(fields, figure);
    if (traced) read_tracing(fields, figure, *kind);
    fields.finish();
    return figure;
  }

 private:
  template <class T>
  std::vector<std::string> labels(Fields& fields, const std::string& key, const std::vector<T>& things, std::string_view what) {
    const YamlNode* node = fields.find(key);
    if (node == nullptr) return labels_of(things);
    std::vector<std::string> all;
    for (const YamlEntry& name : read_names(reading_, *node, fmt::format("'{}'", key))) {
      for (std::string& label : lookup_.all_of(things, name, what)) all.push_back(std::move(label));
    }
    return all;
  }

  /// Whether the quantity drawn is a traced one.
  bool check_line(Fields& fields, const FigureSpec& figure) {
    const YamlNode* y = fields.find("y");
    const std::string& name = figure.options.at("y");
    const std::optional<Quantity> quantity = lookup_.quantity(name, y == nullptr ? figure.where : y->where);
    if (!quantity) return false;
    const bool over_axis = figure.options.at("x") == "axis";
    if (over_axis == quantity->axis.empty()) {
      reading_.report(y == nullptr ? figure.where : y->where,
                      over_axis ? fmt::format("'{}' is one number and has no axis of its own", name)
                                : fmt::format("'{}' is a series over {}", name, quantity->axis),
                      over_axis ? "a series, or 'x: triangles'" : "a quantity of one number, or 'x: axis'");
    }
    return quantity->traced;
  }

  void read_tracing(Fields& fields, FigureSpec& figure, const FigureKind& kind) {
    figure.workloads = labels(fields, "workloads", plan_.workloads, "workload");
    const std::string owner = fmt::format("figure '{}'", figure.name);
    if (figure.workloads.empty() && plan_.workloads.empty()) {
      reading_.report(figure.where, fmt::format("{} needs rays", owner), "'workloads' in the experiment");
    }
    if (kind.name == "line" && figure.workloads.size() > 1) {
      reading_.report(figure.where, fmt::format("{} draws one workload and has several", owner),
                      fmt::format("'workloads', one of {}", fmt::join(figure.workloads, ", ")));
    }
    if (!kind.drawn_per_method) return;
    const YamlNode* tracer = fields.find("tracer");
    if (tracer == nullptr && kind.takes_own_tracers) {
      figure.tracer = own_tracer;
    } else {
      figure.tracer = (tracer == nullptr ? lookup_.the_only(plan_.tracers, figure.where, owner, "tracer")
                       : kind.name == "line" || kind.takes_own_tracers ? lookup_.tracer(*tracer)
                                                                       : lookup_.one_of(plan_.tracers, *tracer, "tracer"))
                          .value_or("");
    }
    if (figure.tracer.empty()) return;
    for (const std::string& method : figure.methods) lookup_.check_traced(figure.tracer, method, figure.where, owner + " shows");
  }

  void read_styles(Fields& fields, FigureSpec& figure) {
    const YamlNode* node = fields.find("styles");
    if (node == nullptr) return;
    if (!node->is_map()) {
      reading_.report(node->where, fmt::format("'styles' is {}", described(*node)),
                      "a map of method to style, such as 'sah: red dashed'");
      return;
    }
    for (const YamlEntry& entry : node->entries) {
      if (!entry.value->is_scalar() || !is_style(entry.value->text)) {
        reading_.report(entry.value->where, fmt::format("the style of '{}' is {}", entry.key, described(*entry.value)),
                        "a colour (a name or #rrggbb), then solid, dashed or dotted, such as 'red dashed'");
        continue;
      }
      for (const std::string& label : lookup_.all_of(plan_.pipelines, {entry.key, entry.where, nullptr}, "method")) {
        figure.styles[label] = entry.value->text;
      }
    }
  }

  static bool is_style(std::string_view text) {
    const std::size_t space = text.find(' ');
    const std::string_view color = text.substr(0, space);
    const std::string_view line = space == std::string_view::npos ? "solid" : text.substr(space + 1);
    const auto all_in = [](std::string_view letters, std::string_view set) {
      return !letters.empty() && letters.find_first_not_of(set) == std::string_view::npos;
    };
    const bool is_color = !color.empty() && color.front() == '#'
                              ? color.size() == 7 && all_in(color.substr(1), "0123456789abcdefABCDEF")
                              : all_in(color, "abcdefghijklmnopqrstuvwxyz");
    return is_color && (line == "solid" || line == "dashed" || line == "dotted");
  }

  Reading& reading_;
  const Plan& plan_;
  Lookup lookup_;
};

}  // namespace

void read_figures(Reading& reading, const YamlNode& node, Plan& plan) {
  if (!node.is_map()) {
    reading.report(node.where, fmt::format("'figures' is {}", described(node)), "a map of name to figure");
    return;
  }
  for (const YamlEntry& entry : node.entries) {
    check_label(reading, entry.where, entry.key);
    plan.figures.push_back(FigureReader(reading, plan).read(entry));
  }
}

}  // namespace raystudy
