#include "harness/spec/lookup.h"

#include "harness/method/registry.h"

namespace raystudy {

Lookup::Lookup(Reading& reading, const Plan& plan) : reading_(reading), quantities_(harness_quantities()) {
  for (const MethodRef& metric : plan.metrics) {
    for (Quantity& quantity : metric_quantities(metric.name)) quantities_.push_back(std::move(quantity));
  }
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
