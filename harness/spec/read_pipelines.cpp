#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "harness/accel/bvh2.h"
#include "harness/method/registry.h"
#include "harness/spec/read_method.h"
#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

/// A method as it is written, with everything it takes over from the one it is made `from`.
struct Draft {
  std::vector<MethodChoice> builder;
  std::vector<std::vector<MethodChoice>> optimizers;
  std::vector<MethodChoice> updater;  ///< empty: none
  std::vector<MethodChoice> encoder;  ///< empty: none
  std::optional<std::vector<YamlEntry>> tracers;
  int threads = 1;
  bool good = true;
};

class PipelineReader {
 public:
  PipelineReader(Reading& reading, const YamlNode& node, Plan& plan) : reading_(reading), node_(node), plan_(plan) {
    for (const YamlEntry& entry : node.entries) {
      names_.push_back(entry.key);
      reading.declared["method"].insert(entry.key);
    }
  }

  void read() {
    for (const YamlEntry& entry : node_.entries) {
      check_label(reading_, entry.where, entry.key);
      const Draft& draft = this->draft(entry);
      if (draft.good) expand(entry, draft);
    }
  }

 private:
  const Draft& draft(const YamlEntry& entry) {
    if (const auto done = drafts_.find(entry.key); done != drafts_.end()) return done->second;
    path_.push_back(entry.key);
    Draft made = read_draft(entry);
    path_.pop_back();
    return drafts_[entry.key] = std::move(made);
  }

  Draft read_draft(const YamlEntry& entry) {
    const YamlNode& written = reading_.at_scale(*entry.value);
    Draft draft;
    draft.threads = plan_.threads;
    if (written.is_scalar()) {  // `sah: sweep-sah`
      draft.builder = read_method(reading_, written, Role::builder, "builder");
      draft.good = !draft.builder.empty();
      if (draft.good) check_update(draft, entry.where, entry.key);
      return draft;
    }
    Fields fields(reading_, written, fmt::format("method '{}'", entry.key));
    if (!fields.is_map()) {
      draft.good = false;
      return draft;
    }
    if (const YamlNode* from = fields.find("from")) draft = inherited(*from);
    if (const YamlNode* builder = fields.find("builder")) {
      draft.builder = read_method(reading_, *builder, Role::builder, "builder");
      draft.good = draft.good && !draft.builder.empty();
    } else if (draft.good && draft.builder.empty()) {
      reading_.report(entry.where, fmt::format("method '{}' has no builder", entry.key), "'builder' or 'from'");
      draft.good = false;
    }
    if (const YamlNode* optimize = fields.find("optimize")) read_optimizers(*optimize, draft);
    read_stage(fields, "update", Role::updater, draft.updater, draft);
    read_stage(fields, "encode", Role::encoder, draft.encoder, draft);
    if (draft.good) check_update(draft, entry.where, entry.key);
    if (const YamlNode* tracers = fields.find("tracers")) draft.tracers = read_names(reading_, *tracers, "'tracers'");
    draft.threads = static_cast<int>(std::get<std::int64_t>(fields.value(threads_param(draft.threads))));
    fields.finish();
    return draft;
  }

  void read_stage(Fields& fields, const char* key, Role role, std::vector<MethodChoice>& choices, Draft& draft) {
    const YamlNode* node = fields.find(key);
    if (node == nullptr) return;
    choices = read_method(reading_, *node, role, key);
    draft.good = draft.good && !choices.empty();
  }

  /// Every method of an animation says how its tree follows it, and no other does.
  void check_update(Draft& draft, const SourceLocation& where, const std::string& name) {
    if (draft.updater.empty() == !plan_.animation.has_value()) return;
    draft.good = false;
    if (draft.updater.empty()) {
      reading_.report(where, fmt::format("method '{}' does not say how its tree follows the animation", name),
                      fmt::format("'update', one of {}", fmt::join(Registry::instance().names(Role::updater), ", ")));
    } else {
      reading_.report(draft.updater.front().where,
                      fmt::format("method '{}' has 'update', and the experiment plays no animation", name),
                      "'animation: {frames: 50}' in the experiment");
    }
  }

  void read_optimizers(const YamlNode& node, Draft& draft) {
    std::vector<const YamlNode*> stages{&node};
    if (node.is_list()) {
      stages.clear();
      for (const auto& item : node.items) stages.push_back(item.get());
    }
    for (const YamlNode* stage : stages) {
      draft.optimizers.push_back(read_method(reading_, *stage, Role::optimizer, "optimize"));
      draft.good = draft.good && !draft.optimizers.back().empty();
    }
  }

  Draft inherited(const YamlNode& from) {
    Draft failed;
    failed.good = false;
    if (!from.is_scalar()) {
      reading_.report(from.where, fmt::format("'from' is {}", described(from)), "the name of a method");
      return failed;
    }
    const auto parent =
        std::find_if(node_.entries.begin(), node_.entries.end(), [&](const YamlEntry& e) { return e.key == from.text; });
    if (parent == node_.entries.end()) {
      reading_.report_unknown(from.where, fmt::format("there is no method '{}' in this experiment", from.text), from.text,
                              names_);
      return failed;
    }
    if (const auto again = std::find(path_.begin(), path_.end(), from.text); again != path_.end()) {
      reading_.report(from.where,
                      fmt::format("'from' goes round in a circle: {} → {}", fmt::join(again, path_.end(), " → "), from.text),
                      "a chain that ends in a builder");
      return failed;
    }
    return draft(*parent);
  }

  /// Every combination of the stages' sweeps becomes a pipeline of the plan.
  void expand(const YamlEntry& entry, const Draft& draft) {
    std::vector<const std::vector<MethodChoice>*> stages{&draft.builder};
    for (const auto& optimizer : draft.optimizers) stages.push_back(&optimizer);
    if (!draft.updater.empty()) stages.push_back(&draft.updater);
    if (!draft.encoder.empty()) stages.push_back(&draft.encoder);
    std::size_t points = 1;
    for (const auto* stage : stages) {
      points *= stage->size();
      if (points <= max_sweep_points) continue;
      reading_.report(entry.where, fmt::format("the sweep of method '{}' has more than {} points", entry.key, max_sweep_points),
                      "fewer values in its lists");
      return;
    }
    for (std::size_t point = 0; point < points; ++point) {
      std::vector<const MethodChoice*> chosen(stages.size());
      std::size_t rest = point;
      for (std::size_t i = stages.size(); i-- > 0;) {
        chosen[i] = &(*stages[i])[rest % stages[i]->size()];
        rest /= stages[i]->size();
      }
      add(entry, draft, chosen);
    }
  }

  void add(const YamlEntry& entry, const Draft& draft, const std::vector<const MethodChoice*>& stages) {
    PipelineSpec pipeline;
    pipeline.base = entry.key;
    pipeline.where = entry.where;
    pipeline.threads = draft.threads;
    std::vector<SweepValue> sweep;
    for (const MethodChoice* stage : stages) sweep.insert(sweep.end(), stage->sweep.begin(), stage->sweep.end());
    pipeline.label = sweep_label(entry.key, sweep);
    const std::vector<std::string> names = sweep_names(sweep);
    for (std::size_t i = 0; i < sweep.size(); ++i) pipeline.sweep[names[i]] = sweep[i].value;
    pipeline.builder = stages.front()->ref;
    for (std::size_t i = 1; i <= draft.optimizers.size(); ++i) pipeline.optimizers.push_back(stages[i]->ref);
    if (!draft.updater.empty()) pipeline.updater = stages[1 + draft.optimizers.size()]->ref;
    if (!draft.encoder.empty()) pipeline.encoder = stages.back()->ref;
    const std::optional<std::string> kind = check_stages(draft, stages);
    if (!kind) return;
    choose_tracers(entry, draft, *kind, pipeline);
    plan_.pipelines.push_back(std::move(pipeline));
  }

  /// The kind of structure that comes out at the end, or nothing where a stage cannot take what the one before makes.
  std::optional<std::string> check_stages(const Draft& draft, const std::vector<const MethodChoice*>& stages) {
    const Registry& registry = Registry::instance();
    const std::string kind = registry.get(Role::builder, stages.front()->ref.name).info.accel;
    for (std::size_t i = 1; i < stages.size(); ++i) {
      const bool is_updater = !draft.updater.empty() && i == draft.optimizers.size() + 1;
      const Role role = i <= draft.optimizers.size() ? Role::optimizer : is_updater ? Role::updater : Role::encoder;
      if (kind == Bvh2::kind_name || (is_updater && registry.get(role, stages[i]->ref.name).info.accel.empty())) continue;
      reading_.report(stages[i]->where,
                      fmt::format("{} '{}' cannot take what builder '{}' makes ('{}')", role_name(role), stages[i]->ref.name,
                                  stages.front()->ref.name, kind),
                      fmt::format("a builder of '{}'", Bvh2::kind_name));
      return std::nullopt;
    }
    return draft.encoder.empty() ? kind : registry.get(Role::encoder, stages.back()->ref.name).info.accel;
  }

  void choose_tracers(const YamlEntry& entry, const Draft& draft, const std::string& kind, PipelineSpec& pipeline) {
    const auto takes = [&kind](const TracerSpec& tracer) {
      const std::string& accel = Registry::instance().get(Role::tracer, tracer.tracer.name).info.accel;
      return accel.empty() || accel == kind;
    };
    if (!draft.tracers) {
      for (const TracerSpec& tracer : plan_.tracers) {
        if (takes(tracer)) pipeline.tracers.push_back(tracer.label);
      }
      if (pipeline.tracers.empty() && !plan_.tracers.empty()) {
        reading_.report(entry.where,
                        fmt::format("no tracer of this experiment can trace what method '{}' makes ('{}')", entry.key, kind),
                        "such a tracer in 'tracers', or 'tracers: []' in the method to build it only");
      }
      return;
    }
    for (const YamlEntry& name : *draft.tracers) {
      bool known = false;
      for (const TracerSpec& tracer : plan_.tracers) {
        if (tracer.label != name.key && tracer.base != name.key) continue;
        known = true;
        if (takes(tracer)) {
          pipeline.tracers.push_back(tracer.label);
        } else {
          reading_.report(name.where,
                          fmt::format("tracer '{}' cannot trace what method '{}' makes ('{}')", name.key, entry.key, kind),
                          fmt::format("a tracer of '{}'", kind));
        }
      }
      if (!known && !reading_.declared["tracer"].contains(name.key)) {
        reading_.report_unknown(name.where, fmt::format("there is no tracer '{}' in this experiment", name.key), name.key,
                                labels_of(plan_.tracers));
      }
    }
  }

  Reading& reading_;
  const YamlNode& node_;
  Plan& plan_;
  std::vector<std::string> names_;
  std::map<std::string, Draft> drafts_;
  std::vector<std::string> path_;
};

}  // namespace

void read_pipelines(Reading& reading, const YamlNode& node, Plan& plan) {
  if (!node.is_map() || node.entries.empty()) {
    reading.report(node.where, fmt::format("'methods' is {}", node.is_map() ? "empty" : described(node)),
                   "a map of name to pipeline, such as 'sah: {builder: sweep-sah}'");
    return;
  }
  PipelineReader(reading, node, plan).read();
}

}  // namespace raystudy
