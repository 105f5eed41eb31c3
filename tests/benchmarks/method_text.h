#pragma once

// Methods as the benchmarks' environment variables name them.

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "harness/method/registry.h"

namespace raystudy::benchmarks {

using Changes = std::map<std::string, ParamValue, std::less<>>;

inline std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t at = std::min(text.find(separator), text.size());
    parts.emplace_back(text.substr(0, at));
    text.remove_prefix(std::min(at + 1, text.size()));
  }
  return parts;
}

inline ParamValue value_of(const ParamSpec& spec, const std::string& text) {
  switch (spec.type) {
    case ParamType::boolean: return text == "true";
    case ParamType::integer: return std::int64_t{std::stoll(text)};
    case ParamType::real: return std::stod(text);
    default: return text;
  }
}

/// NAME or NAME(key=value;…) of any of the roles; the first that has the name.
inline std::pair<Role, MethodRef> method(const std::string& text, std::initializer_list<Role> roles) {
  const std::size_t open = text.find('(');
  const std::string name = text.substr(0, open);
  const Registry& registry = Registry::instance();
  for (const Role role : roles) {
    const Registry::Entry* entry = registry.find(role, name);
    if (entry == nullptr) continue;
    Changes changes;
    if (open != std::string::npos) {
      for (const std::string& change : split(text.substr(open + 1, text.size() - open - 2), ';')) {
        const std::string key = change.substr(0, change.find('='));
        for (const ParamSpec& spec : entry->info.params) {
          if (spec.name == key) changes[key] = value_of(spec, change.substr(key.size() + 1));
        }
      }
    }
    return {role, registry.ref(role, name, std::move(changes))};
  }
  return {*roles.begin(), registry.ref(*roles.begin(), name)};  // throws, with the nearest name
}

}  // namespace raystudy::benchmarks
