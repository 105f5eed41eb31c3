#include "harness/run/result.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace raystudy {
namespace {

using nlohmann::json;

constexpr int format_version = 1;
constexpr std::array<std::string_view, 3> class_names{"exact", "ratio", "absolute"};
constexpr std::array<std::string_view, 3> status_names{"done", "failed", "missing"};
constexpr std::string_view cure = "a result as 'raystudy run' writes it (delete the file to have its cell measured again)";

[[noreturn]] void refuse(SourceLocation where, std::string message) {
  throw Error(Diagnostic{std::move(where), std::move(message), std::string(cure), {}});
}

/// Line and column, from 1, of a byte of `text`, from 1 as the JSON parser counts.
SourceLocation locate(std::string_view text, std::size_t byte, std::string_view source) {
  const std::string_view before = text.substr(0, std::min(text.size(), byte == 0 ? 0 : byte - 1));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  const std::size_t column = before.size() - (newline == std::string_view::npos ? 0 : newline + 1) + 1;
  return {std::string(source), static_cast<int>(line), static_cast<int>(column)};
}

void require_finite(const std::vector<double>& numbers, std::string_view name) {
  const bool finite = std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); });
  if (!finite) throw std::logic_error(fmt::format("write_result: '{}' holds a number that is not finite", name));
}

json to_json(const Measurement& m) {
  return {{"class", value_class_name(m.value_class)}, {"unit", m.unit}, {"samples", m.samples}};
}

json to_json(const Series& s) { return {{"x_name", s.x_name}, {"x_unit", s.x_unit}, {"unit", s.unit}, {"x", s.x}, {"y", s.y}}; }

template <std::size_t N>
std::size_t index_of(const std::array<std::string_view, N>& names, const std::string& name, std::string_view what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::invalid_argument(fmt::format("'{}' is no {}", name, what));
  return static_cast<std::size_t>(found - names.begin());
}

Measurement measurement_from(const json& object) {
  return {static_cast<ValueClass>(index_of(class_names, object.at("class").get<std::string>(), "class of number")),
          object.at("unit").get<std::string>(), object.at("samples").get<std::vector<double>>()};
}

Series series_from(const std::string& name, const json& object) {
  Series s{object.at("x_name").get<std::string>(), object.at("x_unit").get<std::string>(), object.at("unit").get<std::string>(),
           object.at("x").get<std::vector<double>>(), object.at("y").get<std::vector<double>>()};
  if (s.x.size() != s.y.size()) {
    throw std::invalid_argument(fmt::format("series '{}' has {} numbers on x and {} on y", name, s.x.size(), s.y.size()));
  }
  return s;
}

CellResult result_from(const json& object) {
  if (const int version = object.at("format").get<int>(); version != format_version) {
    throw std::invalid_argument(fmt::format("its format is {}, this Raystudy knows {}", version, format_version));
  }
  CellResult r;
  r.id = object.at("id").get<std::string>();
  r.experiment = object.at("experiment").get<std::string>();
  r.scene = object.at("scene").get<std::string>();
  r.method = object.at("method").get<std::string>();
  r.tracer = object.at("tracer").get<std::string>();
  r.workload = object.at("workload").get<std::string>();
  r.status = static_cast<CellStatus>(index_of(status_names, object.at("status").get<std::string>(), "status"));
  r.reason = object.at("reason").get<std::string>();
  for (const auto& [name, value] : object.at("values").items()) r.values[name] = measurement_from(value);
  for (const auto& [name, value] : object.at("series").items()) r.series[name] = series_from(name, value);
  r.provenance = object.at("provenance").get<std::map<std::string, std::string>>();
  return r;
}

}  // namespace

std::string_view value_class_name(ValueClass c) { return class_names.at(static_cast<std::size_t>(c)); }

std::string_view cell_status_name(CellStatus status) { return status_names.at(static_cast<std::size_t>(status)); }

double Measurement::median() const {
  if (samples.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sorted = samples;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

std::filesystem::path result_file(const std::filesystem::path& folder, std::string_view id) {
  return folder / fmt::format("{}.json", id);
}

std::string result_to_json(const CellResult& result) {
  json values = json::object();
  for (const auto& [name, value] : result.values) {
    require_finite(value.samples, name);
    values[name] = to_json(value);
  }
  json series = json::object();
  for (const auto& [name, value] : result.series) {
    require_finite(value.x, name);
    require_finite(value.y, name);
    series[name] = to_json(value);
  }
  const nlohmann::ordered_json object{{"format", format_version},
                                      {"id", result.id},
                                      {"experiment", result.experiment},
                                      {"scene", result.scene},
                                      {"method", result.method},
                                      {"tracer", result.tracer},
                                      {"workload", result.workload},
                                      {"status", cell_status_name(result.status)},
                                      {"reason", result.reason},
                                      {"values", values},
                                      {"series", series},
                                      {"provenance", result.provenance}};
  // A method may put bytes that are no UTF-8 into an error's text; a result is not lost over that.
  return object.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

CellResult result_from_json(std::string_view text, std::string_view source) {
  const SourceLocation where{std::string(source)};
  if (text.empty()) refuse(where, "the result is empty");
  try {
    return result_from(json::parse(text));
  } catch (const json::parse_error& error) {
    refuse(locate(text, error.byte, source),
           error.byte > text.size() ? "the result breaks off" : "the result is not valid JSON from here on");
  } catch (const json::exception& error) {
    // Drops the library's "[json.exception.type_error.302] ".
    const std::string_view full = error.what();
    const std::size_t bracket = full.find("] ");
    refuse(where, fmt::format("not a result: {}", bracket == std::string_view::npos ? full : full.substr(bracket + 2)));
  } catch (const std::invalid_argument& error) {
    refuse(where, fmt::format("not a result: {}", error.what()));
  }
}

void write_result(const std::filesystem::path& folder, const CellResult& result) {
  const Durable durable = result.status == CellStatus::missing ? Durable::no : Durable::yes;
  write_file_atomically(result_file(folder, result.id), result_to_json(result), durable);
}

CellResult read_result(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw Error(
        Diagnostic{{file.string()}, fmt::format("cannot read the result: {}", std::generic_category().message(errno)), {}, {}});
  }
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return result_from_json(text, file.string());
}

}  // namespace raystudy
