#include "harness/spec/parse_pipeline.h"

#include <fmt/format.h>

#include <memory>

#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

std::shared_ptr<YamlNode> node_of(YamlNode::Kind kind) {
  auto node = std::make_shared<YamlNode>();
  node->kind = kind;
  return node;
}

std::shared_ptr<const YamlNode> method_of(const std::string& text, const char* flag, Reading& reading) {
  auto node = std::make_shared<YamlNode>(*parse_yaml(text, flag, reading.problems));
  node->where.file = flag;  // that of an empty text stands nowhere
  return node;
}

}  // namespace

PipelineSpec parse_pipeline(const PipelineText& text) {
  Reading reading;
  const auto pipeline = node_of(YamlNode::Kind::map);
  pipeline->entries.push_back({"builder", {"--builder"}, method_of(text.builder, "--builder", reading)});
  const auto optimizers = node_of(YamlNode::Kind::list);
  for (const std::string& optimizer : text.optimizers) {
    optimizers->items.push_back(method_of(optimizer, "--optimize", reading));
  }
  pipeline->entries.push_back({"optimize", {"--optimize"}, optimizers});
  if (!text.encoder.empty()) {
    pipeline->entries.push_back({"encode", {"--encode"}, method_of(text.encoder, "--encode", reading)});
  }
  const auto methods = node_of(YamlNode::Kind::map);
  methods->entries.push_back({"pipeline", {}, pipeline});
  Plan plan;
  read_pipelines(reading, *methods, plan);
  if (plan.pipelines.size() > 1) {
    reading.report({}, fmt::format("the methods make {} pipelines", plan.pipelines.size()), "one: a single value everywhere");
  }
  if (!reading.problems.empty()) throw Error(std::move(reading.problems));
  PipelineSpec spec = std::move(plan.pipelines.front());
  spec.label = spec.builder.name;
  for (const MethodRef& optimizer : spec.optimizers) spec.label += " + " + optimizer.name;
  if (spec.encoder) spec.label += " + " + spec.encoder->name;
  return spec;
}

}  // namespace raystudy
