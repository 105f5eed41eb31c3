#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace raystudy {

enum class Role : std::uint8_t { builder, optimizer, encoder, heuristic, tracer, workload, metric, updater };
[[nodiscard]] std::string_view role_name(Role role);

class Params;

/// A registered method together with checked parameters; the value of a `method` parameter.
struct MethodRef {
  std::string name;
  std::shared_ptr<const Params> params;
};

/// A file that a method reads; the value of a `file` parameter. Its content, not only its name, is part of a cell's name.
struct FileRef {
  std::string path;  ///< empty: none
  std::string hash;  ///< 32 hex digits of XXH3-128 over the content when the parameter was checked
};

using ParamValue = std::variant<bool, std::int64_t, double, std::string, MethodRef, FileRef>;

enum class ParamType : std::uint8_t { boolean, integer, real, text, choice, method, file };

/// One parameter of a method: the single source for checking YAML, `describe`, the docs and the cell's name.
struct ParamSpec {
  std::string name;
  ParamType type = ParamType::real;
  ParamValue fallback;  ///< the default
  std::string summary;  ///< one line, with the unit where there is one
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool lowest_is_open = false;         ///< the range excludes `lowest`
  std::vector<std::string> choices{};  ///< of a `choice`
  Role role = Role::heuristic;         ///< of a `method`
};

[[nodiscard]] ParamSpec boolean_param(std::string name, bool fallback, std::string summary);
[[nodiscard]] ParamSpec integer_param(std::string name, std::int64_t fallback, std::string summary, double lowest,
                                      double highest);
[[nodiscard]] ParamSpec real_param(std::string name, double fallback, std::string summary, double lowest, double highest);
[[nodiscard]] ParamSpec text_param(std::string name, std::string fallback, std::string summary);
/// The default is the first choice.
[[nodiscard]] ParamSpec choice_param(std::string name, std::vector<std::string> choices, std::string summary);
/// A method of another role, e.g. the heuristic of a builder; the default is named, with its own default parameters.
[[nodiscard]] ParamSpec method_param(std::string name, Role role, std::string fallback, std::string summary);
/// A file that must be named: the default is none, with which the method cannot work.
[[nodiscard]] ParamSpec file_param(std::string name, std::string summary);

/// Checked parameters of one method: every declared name has a value of its declared type.
class Params {
 public:
  Params() = default;
  explicit Params(std::map<std::string, ParamValue, std::less<>> values) : values_(std::move(values)) {}

  // Reading a name that the method did not declare, or with another type, is a mistake in the plugin: std::logic_error.
  [[nodiscard]] bool boolean(std::string_view name) const;
  [[nodiscard]] std::int64_t integer(std::string_view name) const;
  [[nodiscard]] double real(std::string_view name) const;
  [[nodiscard]] const std::string& text(std::string_view name) const;  ///< of `text` and `choice`
  [[nodiscard]] const MethodRef& method(std::string_view name) const;
  [[nodiscard]] const FileRef& file(std::string_view name) const;

  [[nodiscard]] const std::map<std::string, ParamValue, std::less<>>& values() const { return values_; }
  /// `name=value` in the order of names, nested methods in braces: equal text means equal parameters. Part of a cell's name.
  [[nodiscard]] std::string canonical() const;

 private:
  template <class T>
  const T& get(std::string_view name) const;
  std::map<std::string, ParamValue, std::less<>> values_;
};

/// `name{canonical params}`.
[[nodiscard]] std::string canonical(const MethodRef& ref);

}  // namespace raystudy
