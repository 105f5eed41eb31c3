#include "harness/spec/schema.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/method/registry.h"
#include "harness/spec/figure_kinds.h"
#include "harness/spec/quantity.h"
#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

using nlohmann::json;

json reference(const std::string& name) { return {{"$ref", "#/$defs/" + name}}; }

/// `schema` itself, or a map that gives it by scale.
json by_scale(const json& schema) {
  json scales = {{"type", "object"}, {"additionalProperties", false}, {"required", json::array({"quick"})}};
  for (const char* scale : {"quick", "full", "paper"}) scales["properties"][scale] = schema;
  return {{"anyOf", json::array({schema, scales})}};
}

json list_of(const json& schema) { return {{"type", "array"}, {"items", schema}}; }
json one_or_list(const json& schema) { return {{"anyOf", json::array({schema, list_of(schema)})}}; }
json map_of(const json& schema) { return {{"type", "object"}, {"additionalProperties", schema}}; }
json one_of_names(const std::vector<std::string>& names) { return {{"enum", names}}; }
json text() { return {{"type", "string"}}; }
json object(json properties) {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", std::move(properties)}};
}

json type_of(const ParamSpec& spec) {
  switch (spec.type) {
    case ParamType::boolean: return {{"type", "boolean"}};
    case ParamType::integer:
    case ParamType::real: {
      json schema = {{"type", spec.type == ParamType::integer ? "integer" : "number"}};
      if (!std::isinf(spec.lowest)) schema[spec.lowest_is_open ? "exclusiveMinimum" : "minimum"] = spec.lowest;
      if (!std::isinf(spec.highest)) schema["maximum"] = spec.highest;
      return schema;
    }
    case ParamType::choice: return one_of_names(spec.choices);
    case ParamType::text: return {{"type", json::array({"string", "number", "boolean"})}};
    case ParamType::file: return text();
    case ParamType::method: return reference(std::string(role_name(spec.role)));
  }
  return {};
}

json params_of(const std::vector<ParamSpec>& specs, bool sweeps) {
  json properties = json::object();
  for (const ParamSpec& spec : specs) {
    const json type = type_of(spec);
    properties[spec.name] = by_scale(sweeps ? one_or_list(type) : type);
    properties[spec.name]["description"] = spec.summary;
  }
  return properties;
}

/// `NAME` or `NAME: {parameters}` of one role.
json method_schema(Role role) {
  const Registry& registry = Registry::instance();
  json alternatives = json::array({one_of_names(registry.names(role))});
  for (const std::string& name : registry.names(role)) {
    const MethodInfo& info = registry.get(role, name).info;
    json params = object(params_of(info.params, true));
    params["type"] = json::array({"object", "null"});
    json one = object({{name, std::move(params)}});
    one["required"] = json::array({name});
    one["description"] = info.summary;
    alternatives.push_back(std::move(one));
  }
  return {{"anyOf", std::move(alternatives)}};
}

json scene_schema() {
  json generated = json::object();
  const json count = by_scale(one_or_list({{"type", "integer"}, {"minimum", 1000}, {"maximum", 100000000}}));
  for (const std::string& name : known_scene_names()) {
    generated[name] = {
        {"type", json::array({"object", "null"})},
        {"properties", {{"triangles", count}, {"seed", by_scale({{"type", "integer"}, {"minimum", 0}})}, {"label", text()}}},
        {"additionalProperties", false}};
  }
  json one = object(std::move(generated));
  one["minProperties"] = one["maxProperties"] = 1;
  return {{"anyOf", json::array({one_of_names(known_scene_names()), {{"type", "string"}, {"pattern", "/"}}, one})}};
}

json pipeline_schema() {
  const json builder = by_scale(one_or_list(reference("builder")));
  const json whole = object({{"from", text()},
                             {"builder", builder},
                             {"optimize", by_scale(one_or_list(one_or_list(reference("optimizer"))))},
                             {"update", by_scale(one_or_list(reference("updater")))},
                             {"encode", by_scale(one_or_list(reference("encoder")))},
                             {"tracers", by_scale(one_or_list(text()))},
                             {"threads", by_scale({{"type", "integer"}, {"minimum", 1}})}});
  return {{"anyOf", json::array({one_of_names(Registry::instance().names(Role::builder)), whole})}};
}

std::vector<std::string> quantity_names() {
  std::vector<std::string> names;
  for (const Quantity& quantity : harness_quantities()) names.push_back(quantity.name);
  for (const Quantity& quantity : build_part_quantities()) names.push_back(quantity.name);
  for (const std::string& metric : Registry::instance().names(Role::metric)) {
    for (const Quantity& quantity : metric_quantities(metric)) names.push_back(quantity.name);
  }
  return names;
}

json table_schema() {
  const json metric = reference("quantity");
  const json column = object({{"label", text()},
                              {"metric", metric},
                              {"formula", {{"type", json::array({"string", "number"})}}},
                              {"method", text()},
                              {"best_of", by_scale(one_or_list(text()))},
                              {"tracer", text()},
                              {"workload", text()},
                              {"relative_to", by_scale(one_or_list(text()))},
                              {"at", by_scale({{"anyOf", json::array({text(), map_of(text())})}})},
                              {"until", text()},
                              {"target", by_scale({{"anyOf", json::array({text(), map_of(text())})}})},
                              {"unit", text()},
                              {"decimals", {{"type", "integer"}, {"minimum", 0}, {"maximum", 15}}},
                              {"published", text()}});
  const json kind = one_of_names({"scene", "method"});
  const json quantities = {{"anyOf", json::array({list_of(metric), map_of({{"anyOf", json::array({metric, column})}})})}};
  const json either = {{"anyOf", json::array({kind, quantities})}};
  return object({{"caption", text()},
                 {"rows", either},
                 {"slopes", by_scale({{"type", "boolean"}})},
                 {"only", by_scale(one_or_list(text()))},
                 {"scene", text()},
                 {"tracer", text()},
                 {"workload", text()},
                 {"columns", either}});
}

json figure_schema() {
  json kinds = json::array();
  for (const FigureKind& kind : figure_kinds()) {
    json properties = params_of(kind.options, false);
    properties["kind"] = {{"const", kind.name}};
    properties["caption"] = text();
    properties["scenes"] = by_scale(one_or_list(text()));
    if (kind.drawn_per_method) properties["methods"] = by_scale(one_or_list(text()));
    if (kind.styled) properties["styles"] = map_of(text());
    if (kind.traced || kind.name == "line") properties["workloads"] = by_scale(one_or_list(text()));
    if (kind.drawn_per_method && (kind.traced || kind.name == "line")) properties["tracer"] = text();
    json one = object(std::move(properties));
    one["required"] = json::array({"kind"});
    one["description"] = kind.summary;
    kinds.push_back(std::move(one));
  }
  return {{"anyOf", std::move(kinds)}};
}

}  // namespace

std::string experiment_schema() {
  const auto integer = [](double lowest) { return by_scale({{"type", "integer"}, {"minimum", lowest}}); };
  const json quantity =
      by_scale({{"anyOf", json::array({{{"const", 0}}, {{"type", "string"}, {"pattern", "^[0-9.]+ *[A-Za-z]+$"}}})}});
  const json constant = by_scale({{"type", "number"}, {"minimum", 0}});
  const json tracer = reference("tracer");
  const json workload = reference("workload");
  json schema = object({{"title", text()},
                        {"paper", text()},
                        {"seed", integer(0)},
                        {"threads", integer(1)},
                        {"repetitions", integer(1)},
                        {"warm_up", quantity},
                        {"timeout", quantity},
                        {"memory_limit", quantity},
                        {"cost", object({{"c_T", constant}, {"c_I", constant}, {"heuristic", reference("heuristic")}})},
                        {"animation", object({{"frames", integer(1)}})},
                        {"scenes", by_scale(list_of(reference("scene")))},
                        {"methods", by_scale(map_of(by_scale(reference("pipeline"))))},
                        {"tracers", by_scale({{"anyOf", json::array({list_of(tracer), map_of(one_or_list(tracer))})}})},
                        {"workloads", by_scale({{"anyOf", json::array({list_of(workload), map_of(one_or_list(workload))})}})},
                        {"metrics", by_scale(list_of(reference("metric")))},
                        {"tables", map_of(reference("table"))},
                        {"figures", map_of(reference("figure"))}});
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = "Raystudy experiment";
  schema["required"] = json::array({"scenes", "methods"});
  for (const Role role : {Role::builder, Role::optimizer, Role::encoder, Role::heuristic, Role::tracer, Role::workload,
                          Role::metric, Role::updater}) {
    schema["$defs"][std::string(role_name(role))] = method_schema(role);
  }
  schema["$defs"]["scene"] = scene_schema();
  schema["$defs"]["pipeline"] = pipeline_schema();
  schema["$defs"]["quantity"] = one_of_names(quantity_names());
  schema["$defs"]["table"] = table_schema();
  schema["$defs"]["figure"] = figure_schema();
  return schema.dump(2);
}

}  // namespace raystudy
