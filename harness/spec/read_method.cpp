#include "harness/spec/read_method.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "harness/method/registry.h"

namespace raystudy {
namespace {

/// One value of one parameter, with the sweep that led to it.
struct ValueChoice {
  ParamValue value;
  std::vector<SweepValue> sweep;
};

std::string an(std::string_view noun) {
  const bool vowel = !noun.empty() && std::string_view("aeiou").find(noun.front()) != std::string_view::npos;
  return fmt::format("{} {}", vowel ? "an" : "a", noun);
}

const Registry::Entry* find_method(Reading& reading, const SourceLocation& where, Role role, const std::string& name) {
  const Registry& registry = Registry::instance();
  if (const Registry::Entry* entry = registry.find(role, name)) return entry;
  for (const Registry::Entry* other : registry.entries()) {
    if (other->info.name != name) continue;
    reading.report(where, fmt::format("'{}' is {}", name, an(role_name(other->role))),
                   fmt::format("{}: one of {}", an(role_name(role)), fmt::join(registry.names(role), ", ")));
    return nullptr;
  }
  reading.report_unknown(where, fmt::format("there is no {} '{}'", role_name(role), name), name, registry.names(role));
  return nullptr;
}

/// The values of one parameter: one, or those of a list.
std::vector<ValueChoice> read_values(Reading& reading, const YamlNode& written, const ParamSpec& spec, const std::string& owner,
                                     const std::string& method) {
  const YamlNode& node = reading.at_scale(written);
  std::vector<ValueChoice> choices;
  if (spec.type == ParamType::method) {
    for (MethodChoice& choice : read_method(reading, node, spec.role, spec.name)) {
      choices.push_back({std::move(choice.ref), std::move(choice.sweep)});
    }
    return choices;
  }
  const std::string what = fmt::format("{}: parameter '{}'", owner, spec.name);
  if (!node.is_list()) {
    if (auto value = read_scalar(reading, node, spec, what)) choices.push_back({std::move(*value), {}});
    return choices;
  }
  if (node.items.empty()) reading.report(node.where, fmt::format("{} sweeps over an empty list", what), "at least one value");
  for (const auto& item : node.items) {
    auto value = read_scalar(reading, reading.at_scale(*item), spec, what);
    if (!value) continue;
    const auto same = [&value](const ValueChoice& other) { return label_text(other.value) == label_text(*value); };
    if (std::any_of(choices.begin(), choices.end(), same)) {
      reading.report(item->where, fmt::format("{} sweeps over {} twice", what, label_text(*value)), "each value once");
      continue;
    }
    choices.push_back({*value, {{method, spec.name, *value}}});
  }
  return choices;
}

/// Reports the files that a method needs and that `params` does not name.
bool names_files(Reading& reading, const YamlNode* params, const Registry::Entry& entry, const SourceLocation& where) {
  bool good = true;
  for (const ParamSpec& spec : entry.info.params) {
    if (spec.type != ParamType::file || (params != nullptr && params->find(spec.name) != nullptr)) continue;
    reading.report(where, fmt::format("{} '{}' has no '{}'", role_name(entry.role), entry.info.name, spec.name),
                   expected_text(spec));
    good = false;
  }
  return good;
}

std::vector<MethodChoice> read_params(Reading& reading, const YamlNode* params, const Registry::Entry& entry,
                                      const SourceLocation& where) {
  const std::string owner = fmt::format("{} '{}'", role_name(entry.role), entry.info.name);
  const MethodRef defaults = Registry::instance().ref(entry.role, entry.info.name);
  using Values = std::map<std::string, ParamValue, std::less<>>;
  std::vector<std::pair<Values, std::vector<SweepValue>>> points{{defaults.params->values(), {}}};
  bool good = true;
  if (params != nullptr && !params->is_null()) {
    if (!params->is_map()) {
      reading.report(params->where, fmt::format("the parameters of {} are {}", owner, described(*params)), "a map");
      return {};
    }
    for (const YamlEntry& written : params->entries) {
      const auto& specs = entry.info.params;
      const auto spec = std::find_if(specs.begin(), specs.end(), [&](const ParamSpec& s) { return s.name == written.key; });
      if (spec == specs.end()) {
        std::vector<std::string> known;
        known.reserve(specs.size());
        for (const ParamSpec& s : specs) known.push_back(s.name);
        reading.report_unknown(written.where, fmt::format("{} has no parameter '{}'", owner, written.key), written.key, known);
        good = false;
        continue;
      }
      const std::vector<ValueChoice> values = read_values(reading, *written.value, *spec, owner, entry.info.name);
      good = good && !values.empty();
      if (points.size() * values.size() > max_sweep_points) {
        reading.report(written.where, fmt::format("the sweep of {} has {} points", owner, points.size() * values.size()),
                       fmt::format("at most {}", max_sweep_points));
        return {};
      }
      std::vector<std::pair<Values, std::vector<SweepValue>>> next;
      for (const auto& [point, sweep] : points) {
        for (const ValueChoice& choice : values) {
          auto& [changed, longer] = next.emplace_back(point, sweep);
          changed[spec->name] = choice.value;
          longer.insert(longer.end(), choice.sweep.begin(), choice.sweep.end());
        }
      }
      if (!values.empty()) points = std::move(next);
    }
  }
  if (!good || !names_files(reading, params, entry, where)) return {};
  std::vector<MethodChoice> choices;
  choices.reserve(points.size());
  for (auto& [values, sweep] : points) {
    choices.push_back({{entry.info.name, std::make_shared<const Params>(std::move(values))}, std::move(sweep), where});
  }
  return choices;
}

std::vector<MethodChoice> read_one(Reading& reading, const YamlNode& node, Role role) {
  if (node.is_scalar()) {
    const Registry::Entry* entry = find_method(reading, node.where, role, node.text);
    return entry == nullptr ? std::vector<MethodChoice>{} : read_params(reading, nullptr, *entry, node.where);
  }
  if (!node.is_map() || node.entries.size() != 1) {
    const std::string found = node.is_map() ? fmt::format("a map of {} keys", node.entries.size()) : described(node);
    reading.report(node.where, fmt::format("the {} is {}", role_name(role), found),
                   fmt::format("NAME or {{NAME: {{parameter: value}}}}, with the name of {}", an(role_name(role))));
    return {};
  }
  const YamlEntry& entry = node.entries.front();
  const Registry::Entry* method = find_method(reading, entry.where, role, entry.key);
  if (method == nullptr) return {};
  return read_params(reading, &reading.at_scale(*entry.value), *method, entry.where);
}

}  // namespace

std::vector<MethodChoice> read_method(Reading& reading, const YamlNode& written, Role role, const std::string& what) {
  const YamlNode& node = reading.at_scale(written);
  if (!node.is_list()) return read_one(reading, node, role);
  if (node.items.empty()) {
    reading.report(node.where, fmt::format("'{}' sweeps over an empty list", what),
                   fmt::format("at least one {}", role_name(role)));
  }
  std::vector<MethodChoice> all;
  for (const auto& item : node.items) {
    for (MethodChoice& choice : read_one(reading, reading.at_scale(*item), role)) {
      choice.sweep.insert(choice.sweep.begin(), SweepValue{std::string(role_name(role)), what, choice.ref});
      all.push_back(std::move(choice));
    }
  }
  return all;
}

std::vector<std::string> sweep_names(const std::vector<SweepValue>& sweep) {
  std::vector<std::string> names;
  for (const SweepValue& value : sweep) {
    const auto shares = [&value](const SweepValue& other) { return other.param == value.param; };
    const bool shared = std::count_if(sweep.begin(), sweep.end(), shares) > 1;
    std::string name = shared ? value.method + "." + value.param : value.param;
    const auto taken = std::count_if(names.begin(), names.end(), [&name](const std::string& other) {
      return other == name || other.rfind(name + "#", 0) == 0;
    });
    if (taken > 0) name += fmt::format("#{}", taken + 1);
    names.push_back(std::move(name));
  }
  return names;
}

std::string sweep_label(const std::string& base, const std::vector<SweepValue>& sweep) {
  if (sweep.empty()) return base;
  const std::vector<std::string> names = sweep_names(sweep);
  std::string label = base + "[";
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    label += fmt::format("{}{}={}", i == 0 ? "" : ",", names[i], label_text(sweep[i].value));
  }
  return label + "]";
}

}  // namespace raystudy
