#include "harness/spec/lookup.h"

#include <algorithm>

#include "harness/method/registry.h"

namespace raystudy {

Lookup::Lookup(Reading& reading, const Plan& plan) : reading_(reading), plan_(plan), quantities_(harness_quantities()) {
  for (Quantity& quantity : build_part_quantities()) quantities_.push_back(std::move(quantity));
  for (const MethodRef& metric : plan.metrics) {
    for (Quantity& quantity : metric_quantities(metric.name)) quantities_.push_back(std::move(quantity));
  }
}

std::optional<std::string> Lookup::tracer(const YamlNode& node) const {
  if (node.is_scalar() && node.text == own_tracer) return own_tracer;
  return one_of(plan_.tracers, node, "tracer");
}

void Lookup::check_traced(const std::string& tracer, const std::string& method, const SourceLocation& where,
                          const std::string& owner) const {
  const auto pipeline = index_of(plan_.pipelines, method);
  const bool own = tracer == own_tracer;
  if (!pipeline || (!own && !index_of(plan_.tracers, tracer))) return;
  const std::vector<std::string>& tracers = plan_.pipelines[*pipeline].tracers;
  if (own ? tracers.size() == 1 : std::find(tracers.begin(), tracers.end(), tracer) != tracers.end()) return;
  reading_.report(
      where,
      own ? fmt::format("{} the own tracer of method '{}', which has {}", owner, method, tracers.empty() ? "none" : "several")
          : fmt::format("{} tracer '{}', which does not trace method '{}'", owner, tracer, method),
      tracers.empty() ? "a method that is traced" : fmt::format("one of {}", fmt::join(tracers, ", ")));
}

std::optional<Quantity> Lookup::quantity(const std::string& name, const SourceLocation& where) const {
  std::vector<std::string> known;
  for (const Quantity& quantity : quantities_) {
    if (quantity.name == name) return quantity;
    known.push_back(quantity.name);
  }
  const Registry& registry = Registry::instance();
  for (const std::string& metric : registry.names(Role::metric)) {
    for (const Quantity& quantity : metric_quantities(metric)) {
      if (quantity.name != name) continue;
      reading_.report(where, fmt::format("'{}' is not measured by this experiment", name),
                      fmt::format("metric '{}' in 'metrics'", metric));
      return std::nullopt;
    }
  }
  reading_.report_unknown(where, fmt::format("there is no quantity '{}'", name), name, known);
  return std::nullopt;
}

bool Lookup::is_reported(std::string_view name, std::string_view what) const {
  return reading_.declared[std::string(what)].contains(std::string(name));
}

}  // namespace raystudy
