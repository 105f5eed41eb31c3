#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "harness/method/registry.h"
#include "harness/spec/read_method.h"
#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

/// Reads a map of label to method, or a list of methods, of one role; calls add(label, base, choice).
template <class Add>
void read_labelled(Reading& reading, const YamlNode& node, Role role, const std::string& section, const Add& add) {
  const auto add_all = [&](const std::string& base, const SourceLocation& where, const std::vector<MethodChoice>& choices) {
    for (const MethodChoice& choice : choices) {
      const std::string name = base.empty() ? choice.ref.name : base;
      add(sweep_label(name, choice.sweep), name, choice.ref, where);
    }
  };
  if (node.is_list()) {
    for (const auto& item : node.items) {
      const YamlNode& written = reading.at_scale(*item);
      if (written.is_scalar()) reading.declared[std::string(role_name(role))].insert(written.text);
      if (written.is_map() && !written.entries.empty()) {
        reading.declared[std::string(role_name(role))].insert(written.entries.front().key);
      }
      add_all({}, item->where, read_method(reading, *item, role, std::string(role_name(role))));
    }
  } else if (node.is_map()) {
    for (const YamlEntry& entry : node.entries) {
      check_label(reading, entry.where, entry.key);
      reading.declared[std::string(role_name(role))].insert(entry.key);
      add_all(entry.key, entry.where, read_method(reading, *entry.value, role, std::string(role_name(role))));
    }
  } else {
    reading.report(node.where, fmt::format("'{}' is {}", section, described(node)),
                   fmt::format("a map of label to {}, or a list of them", role_name(role)));
  }
}

template <class Spec>
bool is_new(Reading& reading, const std::vector<Spec>& specs, const std::string& label, const SourceLocation& where, Role role) {
  const auto other = index_of(specs, label);
  if (!other) return true;
  reading.report(where, fmt::format("two {}s are called '{}'", role_name(role), label),
                 fmt::format("'LABEL: {}' for one of them, in a map; the first is on line {}", label, specs[*other].where.line));
  return false;
}

bool fits(const Registry::Entry& metric, const Plan& plan) {
  const Registry& registry = Registry::instance();
  return std::any_of(plan.pipelines.begin(), plan.pipelines.end(), [&](const PipelineSpec& pipeline) {
    const std::string& kind = pipeline.encoder ? registry.get(Role::encoder, pipeline.encoder->name).info.accel
                                               : registry.get(Role::builder, pipeline.builder.name).info.accel;
    return metric.info.accel.empty() || metric.info.accel == kind;
  });
}

}  // namespace

void read_tracers(Reading& reading, const YamlNode& node, Plan& plan) {
  read_labelled(reading, node, Role::tracer, "tracers",
                [&](const std::string& label, const std::string& base, const MethodRef& ref, const SourceLocation& where) {
                  if (is_new(reading, plan.tracers, label, where, Role::tracer)) {
                    plan.tracers.push_back({label, base, ref, where});
                  }
                });
}

void read_workloads(Reading& reading, const YamlNode& node, Plan& plan) {
  read_labelled(reading, node, Role::workload, "workloads",
                [&](const std::string& label, const std::string& base, const MethodRef& ref, const SourceLocation& where) {
                  if (is_new(reading, plan.workloads, label, where, Role::workload)) {
                    plan.workloads.push_back({label, base, ref, where});
                  }
                });
}

void read_metrics(Reading& reading, const YamlNode* node, Plan& plan) {
  const Registry& registry = Registry::instance();
  if (node == nullptr) {
    for (const std::string& name : registry.names(Role::metric)) plan.metrics.push_back(registry.ref(Role::metric, name));
    return;
  }
  if (!node->is_list()) {
    reading.report(node->where, fmt::format("'metrics' is {}", described(*node)), "a list of metrics");
    return;
  }
  for (const auto& item : node->items) {
    for (MethodChoice& choice : read_method(reading, *item, Role::metric, "metrics")) {
      const Registry::Entry& entry = registry.get(Role::metric, choice.ref.name);
      if (!plan.pipelines.empty() && !fits(entry, plan)) {
        reading.report(
            item->where,
            fmt::format("metric '{}' takes '{}', which no method of this experiment makes", choice.ref.name, entry.info.accel),
            "a metric of what the methods make");
      }
      plan.metrics.push_back(std::move(choice.ref));
    }
  }
}

}  // namespace raystudy
