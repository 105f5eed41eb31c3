#include "harness/method/params.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace raystudy {
namespace {

ParamSpec make_spec(std::string name, ParamType type, ParamValue fallback, std::string summary) {
  ParamSpec spec;
  spec.name = std::move(name);
  spec.type = type;
  spec.fallback = std::move(fallback);
  spec.summary = std::move(summary);
  return spec;
}

std::string value_text(const ParamValue& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, bool>) {
          return v ? "true" : "false";
        } else if constexpr (std::is_same_v<T, MethodRef>) {
          return canonical(v);
        } else if constexpr (std::is_same_v<T, FileRef>) {
          return v.path.empty() ? std::string() : fmt::format("{} xxh3={}", v.path, v.hash);
        } else {
          return fmt::format("{}", v);  // of a double: the shortest text that reads back as the same double
        }
      },
      value);
}

}  // namespace

std::string_view role_name(Role role) {
  switch (role) {
    case Role::builder: return "builder";
    case Role::optimizer: return "optimizer";
    case Role::encoder: return "encoder";
    case Role::heuristic: return "heuristic";
    case Role::tracer: return "tracer";
    case Role::workload: return "workload";
    case Role::metric: return "metric";
    case Role::updater: return "updater";
  }
  throw std::logic_error("role_name: no such role");
}

ParamSpec boolean_param(std::string name, bool fallback, std::string summary) {
  return make_spec(std::move(name), ParamType::boolean, fallback, std::move(summary));
}

ParamSpec integer_param(std::string name, std::int64_t fallback, std::string summary, double lowest, double highest) {
  ParamSpec spec = make_spec(std::move(name), ParamType::integer, fallback, std::move(summary));
  spec.lowest = lowest;
  spec.highest = highest;
  return spec;
}

ParamSpec real_param(std::string name, double fallback, std::string summary, double lowest, double highest) {
  ParamSpec spec = make_spec(std::move(name), ParamType::real, fallback, std::move(summary));
  spec.lowest = lowest;
  spec.highest = highest;
  return spec;
}

ParamSpec text_param(std::string name, std::string fallback, std::string summary) {
  return make_spec(std::move(name), ParamType::text, std::move(fallback), std::move(summary));
}

ParamSpec choice_param(std::string name, std::vector<std::string> choices, std::string summary) {
  ParamSpec spec = make_spec(std::move(name), ParamType::choice, choices.at(0), std::move(summary));
  spec.choices = std::move(choices);
  return spec;
}

ParamSpec method_param(std::string name, Role role, std::string fallback, std::string summary) {
  ParamSpec spec = make_spec(std::move(name), ParamType::method, MethodRef{std::move(fallback), nullptr}, std::move(summary));
  spec.role = role;
  return spec;
}

ParamSpec file_param(std::string name, std::string summary) {
  return make_spec(std::move(name), ParamType::file, FileRef{}, std::move(summary));
}

template <class T>
const T& Params::get(std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) throw std::logic_error(fmt::format("parameter '{}' was not declared", name));
  const T* value = std::get_if<T>(&found->second);
  if (value == nullptr) throw std::logic_error(fmt::format("parameter '{}' was declared with another type", name));
  return *value;
}

bool Params::boolean(std::string_view name) const { return get<bool>(name); }
std::int64_t Params::integer(std::string_view name) const { return get<std::int64_t>(name); }
double Params::real(std::string_view name) const { return get<double>(name); }
const std::string& Params::text(std::string_view name) const { return get<std::string>(name); }
const MethodRef& Params::method(std::string_view name) const { return get<MethodRef>(name); }
const FileRef& Params::file(std::string_view name) const { return get<FileRef>(name); }

std::string Params::canonical() const {
  std::string text;
  for (const auto& [name, value] : values_) {
    if (!text.empty()) text += ", ";
    text += name + "=" + value_text(value);
  }
  return text;
}

std::string canonical(const MethodRef& ref) {
  return ref.name + "{" + (ref.params ? ref.params->canonical() : std::string{}) + "}";
}

}  // namespace raystudy
