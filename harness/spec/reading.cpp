#include "harness/spec/reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "harness/method/registry.h"

namespace raystudy {
namespace {

constexpr std::array<std::string_view, 3> scale_keys{"quick", "full", "paper"};

bool is_scale_key(std::string_view key) { return std::find(scale_keys.begin(), scale_keys.end(), key) != scale_keys.end(); }

/// A map that speaks of scales: at least one key is one, and the others are misspelt ones.
bool is_over_scales(const YamlNode& node) {
  if (!node.is_map()) return false;
  const std::vector<std::string> known(scale_keys.begin(), scale_keys.end());
  bool any = false;
  for (const YamlEntry& entry : node.entries) {
    if (is_scale_key(entry.key)) {
      any = true;
    } else if (nearest_name(entry.key, known).empty()) {
      return false;
    }
  }
  return any;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  std::int64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc{} && stop == end) return number;
  // 1e6 is a handy way to write a million; a double holds every integer up to 2^53.
  const std::optional<double> real = parse_real(text);
  if (real && *real == std::floor(*real) && std::abs(*real) <= 9007199254740992.0) return static_cast<std::int64_t>(*real);
  return std::nullopt;
}

/// The scalar in the type that `type` asks for, as far as its text allows.
std::optional<ParamValue> parse_as(const YamlNode& node, ParamType type) {
  switch (type) {
    case ParamType::text:
    case ParamType::choice:
    case ParamType::method:
    case ParamType::file: return node.text;
    case ParamType::boolean:
      if (node.plain && (node.text == "true" || node.text == "false")) return node.text == "true";
      return std::nullopt;
    case ParamType::integer:
      if (const auto integer = parse_integer(node.text); node.plain && integer) return *integer;
      return std::nullopt;
    case ParamType::real:
      if (const auto real = parse_real(node.text); node.plain && real) return *real;
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> parse_real(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || stop != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

ParamSpec threads_param(int fallback) { return integer_param("threads", fallback, "", 1, 1024); }

const std::vector<std::pair<std::string, double>>& time_units() {
  static const std::vector<std::pair<std::string, double>> units{{"ms", 0.001}, {"s", 1}, {"min", 60}, {"h", 3600}};
  return units;
}

void Reading::report(const SourceLocation& where, std::string message, std::string expected, std::string nearest) {
  problems.push_back({where, std::move(message), std::move(expected), std::move(nearest)});
}

void Reading::report_unknown(const SourceLocation& where, std::string message, std::string_view found,
                             const std::vector<std::string>& known) {
  report(where, std::move(message), known.empty() ? "none" : fmt::format("one of {}", fmt::join(known, ", ")),
         nearest_name(found, known));
}

const YamlNode& Reading::at_scale(const YamlNode& node) {
  if (!is_over_scales(node)) return node;
  const YamlNode* chosen = nullptr;
  for (const YamlEntry& entry : node.entries) {
    if (!is_scale_key(entry.key)) {
      report_unknown(entry.where, fmt::format("there is no scale '{}'", entry.key), entry.key,
                     {scale_keys.begin(), scale_keys.end()});
    }
  }
  for (int s = static_cast<int>(scale); s >= 0 && chosen == nullptr; --s) {
    chosen = node.find(scale_keys.at(static_cast<std::size_t>(s)));
  }
  if (chosen != nullptr) return *chosen;
  report(node.where, fmt::format("there is no value for scale '{}'", scale_keys.at(static_cast<std::size_t>(scale))),
         "a value for 'quick'; a larger scale without its own takes the next smaller one's");
  return *node.entries.front().value;
}

Fields::Fields(Reading& reading, const YamlNode& node, std::string owner)
    : reading_(reading), node_(&reading.at_scale(node)), owner_(std::move(owner)) {
  if (!node_->is_map()) reading_.report(node_->where, fmt::format("{} is {}", owner_, described(*node_)), "a map");
}

const YamlNode* Fields::find(std::string_view key) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.emplace_back(key);
  const YamlNode* found = node_->find(key);
  return found == nullptr ? nullptr : &reading_.at_scale(*found);
}

const YamlNode* Fields::require(std::string_view key, std::string_view what) {
  const YamlNode* found = find(key);
  if (found == nullptr && node_->is_map()) {
    reading_.report(node_->where, fmt::format("{} has no '{}'", owner_, key), std::string(what));
  }
  return found;
}

std::string Fields::text(std::string_view key, std::string fallback) {
  const YamlNode* found = find(key);
  if (found == nullptr) return fallback;
  if (found->is_scalar()) return found->text;
  reading_.report(found->where, fmt::format("'{}' is {}", key, described(*found)), "a text");
  return fallback;
}

std::vector<YamlEntry> Fields::names(std::string_view key) {
  const YamlNode* found = find(key);
  if (found == nullptr) return {};
  return read_names(reading_, *found, fmt::format("'{}'", key));
}

ParamValue Fields::value(const ParamSpec& spec) {
  const YamlNode* found = find(spec.name);
  if (found == nullptr) return spec.fallback;
  return read_scalar(reading_, *found, spec, fmt::format("'{}'", spec.name)).value_or(spec.fallback);
}

double Fields::quantity(std::string_view key, double fallback, const std::vector<std::pair<std::string, double>>& units,
                        std::string_view example) {
  const YamlNode* found = find(key);
  if (found == nullptr) return fallback;
  std::vector<std::string> names;
  names.reserve(units.size());
  for (const auto& [unit, factor] : units) names.push_back(unit);
  if (found->is_scalar()) {
    const std::string_view text = found->text;
    const std::size_t split = std::min(text.find_last_of("0123456789. "), text.size() - 1) + 1;
    const std::string_view number = text.substr(0, std::min(text.find(' '), split));
    const auto unit = std::find(names.begin(), names.end(), text.substr(split));
    const std::optional<double> value = parse_real(number);
    if (value && *value == 0 && number == text) return 0;
    if (value && *value >= 0 && unit != names.end()) return *value * units[static_cast<std::size_t>(unit - names.begin())].second;
  }
  reading_.report(found->where, fmt::format("'{}' is {}", key, described(*found)),
                  fmt::format("a number >= 0 and a unit ({}), such as '{}'", fmt::join(names, ", "), example));
  return fallback;
}

void Fields::finish() {
  for (const YamlEntry& entry : node_->entries) {
    if (std::find(asked_.begin(), asked_.end(), entry.key) != asked_.end()) continue;
    reading_.report_unknown(entry.where, fmt::format("{} has no key '{}'", owner_, entry.key), entry.key, asked_);
  }
}

std::vector<YamlEntry> read_names(Reading& reading, const YamlNode& node, const std::string& what) {
  if (node.is_scalar()) return {{node.text, node.where, nullptr}};
  if (!node.is_list()) {
    reading.report(node.where, fmt::format("{} is {}", what, described(node)), "a name or a list of names");
    return {};
  }
  std::vector<YamlEntry> names;
  for (const auto& item : node.items) {
    if (item->is_scalar()) {
      names.push_back({item->text, item->where, nullptr});
    } else {
      reading.report(item->where, fmt::format("{} holds {}", what, described(*item)), "a name");
    }
  }
  return names;
}

std::optional<ParamValue> read_scalar(Reading& reading, const YamlNode& node, const ParamSpec& spec, const std::string& what) {
  const std::optional<ParamValue> value = node.is_scalar() ? parse_as(node, spec.type) : std::nullopt;
  std::string nearest;
  if (value) {
    try {
      return checked(spec, *value);
    } catch (const Error& error) {
      nearest = error.diagnostics().front().nearest;
    }
  }
  reading.report(node.where, fmt::format("{} is {}", what, described(node)), expected_text(spec), nearest);
  return std::nullopt;
}

void check_label(Reading& reading, const SourceLocation& where, const std::string& label) {
  const auto refused = [](char c) {
    return std::string_view("/[],").find(c) != std::string_view::npos || (static_cast<unsigned char>(c) < 0x20);
  };
  if (!label.empty() && std::none_of(label.begin(), label.end(), refused)) return;
  reading.report(where, fmt::format("the name '{}' cannot be used", label), "at least one letter, and none of / [ ] ,");
}

std::string label_text(const ParamValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
  if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", *real);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* file = std::get_if<FileRef>(&value)) return std::filesystem::path(file->path).filename().string();
  return std::get<MethodRef>(value).name;
}

}  // namespace raystudy
