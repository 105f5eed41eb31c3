#include "harness/method/registry.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "harness/base/error.h"
#include "harness/scene/bytes.h"

namespace raystudy {
namespace {

std::string described(const ParamValue& value) {
  if (const bool* b = std::get_if<bool>(&value)) return fmt::format("the truth value {}", *b);
  if (const std::int64_t* i = std::get_if<std::int64_t>(&value)) return fmt::format("the integer {}", *i);
  if (const double* d = std::get_if<double>(&value)) return fmt::format("the number {}", *d);
  if (const std::string* s = std::get_if<std::string>(&value)) return fmt::format("the text '{}'", *s);
  if (const FileRef* f = std::get_if<FileRef>(&value)) return fmt::format("the file '{}'", f->path);
  return fmt::format("the method '{}'", std::get<MethodRef>(value).name);
}

[[noreturn]] void refuse(const ParamSpec& spec, const ParamValue& value, std::string nearest = {}) {
  throw Error(
      Diagnostic{{}, fmt::format("parameter '{}' is {}", spec.name, described(value)), expected_text(spec), std::move(nearest)});
}

void require_in_range(const ParamSpec& spec, double number, const ParamValue& value) {
  const bool low = spec.lowest_is_open ? number > spec.lowest : number >= spec.lowest;
  if (!low || !(number <= spec.highest)) refuse(spec, value);  // also refuses NaN
}

/// A file that is named is read for its hash; one that was checked before is taken as it was.
FileRef checked_file(const ParamSpec& spec, const ParamValue& value) {
  if (const FileRef* file = std::get_if<FileRef>(&value)) return *file;
  const std::string* path = std::get_if<std::string>(&value);
  if (path == nullptr || path->empty()) refuse(spec, value);
  try {
    return {*path, xxh3_hex(as_text(map_file(*path)))};
  } catch (const Error&) {
    refuse(spec, value);
  }
}

}  // namespace

std::string expected_text(const ParamSpec& spec) {
  const auto range = [&spec](std::string_view what) {
    if (std::isinf(spec.lowest) && std::isinf(spec.highest)) return std::string(what);
    if (std::isinf(spec.highest)) return fmt::format("{} {} {}", what, spec.lowest_is_open ? ">" : ">=", spec.lowest);
    return fmt::format("{} in {}{}, {}]", what, spec.lowest_is_open ? '(' : '[', spec.lowest, spec.highest);
  };
  switch (spec.type) {
    case ParamType::boolean: return "true or false";
    case ParamType::integer: return range("an integer");
    case ParamType::real: return range("a number");
    case ParamType::text: return "a text";
    case ParamType::choice: return fmt::format("one of {}", fmt::join(spec.choices, ", "));
    case ParamType::method: return fmt::format("a {}", role_name(spec.role));
    case ParamType::file: return "the name of a file that can be read";
  }
  throw std::logic_error("expected_text: no such type");
}

ParamValue checked(const ParamSpec& spec, const ParamValue& value) {
  switch (spec.type) {
    case ParamType::boolean:
      if (!std::holds_alternative<bool>(value)) refuse(spec, value);
      return value;
    case ParamType::integer: {
      const std::int64_t* i = std::get_if<std::int64_t>(&value);
      if (i == nullptr) refuse(spec, value);
      require_in_range(spec, static_cast<double>(*i), value);
      return value;
    }
    case ParamType::real: {
      double number = 0;
      if (const std::int64_t* i = std::get_if<std::int64_t>(&value)) {
        number = static_cast<double>(*i);
      } else if (const double* d = std::get_if<double>(&value)) {
        number = *d;
      } else {
        refuse(spec, value);
      }
      require_in_range(spec, number, value);
      return number;
    }
    case ParamType::text:
      if (!std::holds_alternative<std::string>(value)) refuse(spec, value);
      return value;
    case ParamType::choice: {
      const std::string* text = std::get_if<std::string>(&value);
      if (text == nullptr) refuse(spec, value);
      for (const std::string& choice : spec.choices) {
        if (choice == *text) return value;
      }
      refuse(spec, value, nearest_name(*text, spec.choices));
    }
    case ParamType::method: {
      MethodRef ref;
      if (const std::string* text = std::get_if<std::string>(&value)) {
        ref.name = *text;
      } else if (const MethodRef* method = std::get_if<MethodRef>(&value)) {
        ref = *method;
      } else {
        refuse(spec, value);
      }
      const Registry& registry = Registry::instance();
      if (!ref.params) ref.params = std::make_shared<const Params>(registry.default_params(spec.role, ref.name));
      (void)registry.get(spec.role, ref.name);
      return ref;
    }
    case ParamType::file: return checked_file(spec, value);
  }
  throw std::logic_error("checked: no such type");
}

Registry& Registry::instance() {
  static Registry registry;
  return registry;
}

void Registry::add(Role role, MethodInfo info, Factory make) {
  const std::pair key{role, info.name};
  if (const auto found = entries_.find(key); found != entries_.end()) {
    conflicts_.push_back(fmt::format("two plugins register the {} '{}': one from {}, one from {}", role_name(role), info.name,
                                     found->second.origin, origin_));
    return;
  }
  entries_.emplace(key, Entry{role, std::move(info), std::move(make), origin_});
}

void Registry::require_no_conflicts() const {
  if (conflicts_.empty()) return;
  std::vector<Diagnostic> diagnostics;
  for (const std::string& conflict : conflicts_) diagnostics.push_back({{}, conflict, "one method a name and role", {}});
  throw Error(std::move(diagnostics));
}

const Registry::Entry* Registry::find(Role role, std::string_view name) const {
  const auto found = entries_.find(std::pair{role, std::string(name)});
  return found == entries_.end() ? nullptr : &found->second;
}

const Registry::Entry& Registry::get(Role role, std::string_view name) const {
  if (const Entry* entry = find(role, name)) return *entry;
  const std::vector<std::string> known = names(role);
  throw Error(Diagnostic{{},
                         fmt::format("there is no {} '{}'", role_name(role), name),
                         fmt::format("one of {}", fmt::join(known, ", ")),
                         nearest_name(name, known)});
}

std::vector<std::string> Registry::names(Role role) const {
  std::vector<std::string> names;
  for (const auto& [key, entry] : entries_) {
    if (key.first == role) names.push_back(key.second);
  }
  return names;
}

std::vector<const Registry::Entry*> Registry::entries() const {
  std::vector<const Entry*> all;
  for (const auto& [key, entry] : entries_) all.push_back(&entry);
  return all;
}

Params Registry::default_params(Role role, std::string_view name) const { return *ref(role, name).params; }

MethodRef Registry::ref(Role role, std::string_view name, std::map<std::string, ParamValue, std::less<>> changes) const {
  const Entry& entry = get(role, name);
  std::vector<Diagnostic> diagnostics;
  std::map<std::string, ParamValue, std::less<>> values;
  std::vector<std::string> known;
  for (const ParamSpec& spec : entry.info.params) {
    known.push_back(spec.name);
    const auto change = changes.find(spec.name);
    try {
      values[spec.name] = checked(spec, change == changes.end() ? spec.fallback : change->second);
    } catch (const Error& error) {
      for (Diagnostic d : error.diagnostics()) {
        d.message = fmt::format("{} '{}': {}", role_name(role), name, d.message);
        diagnostics.push_back(std::move(d));
      }
    }
    if (change != changes.end()) changes.erase(change);
  }
  for (const auto& [unknown, value] : changes) {
    diagnostics.push_back({{},
                           fmt::format("{} '{}' has no parameter '{}'", role_name(role), name, unknown),
                           known.empty() ? "no parameters" : fmt::format("one of {}", fmt::join(known, ", ")),
                           nearest_name(unknown, known)});
  }
  if (!diagnostics.empty()) throw Error(std::move(diagnostics));
  return {std::string(name), std::make_shared<const Params>(std::move(values))};
}

TraceCounts TraceSession::count(std::span<const Ray>, Query, std::span<std::uint32_t>) {
  throw std::logic_error("this tracer does not count; ask counts() first");
}

}  // namespace raystudy
