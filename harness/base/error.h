#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace raystudy {

/// Where in an input file something was found. Line and column count from 1; 0 means "not known".
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;

  /// `file:line:column`, leaving out what is not known.
  [[nodiscard]] std::string text() const;
};

/// One thing wrong with an input, in the words a user needs to mend it.
struct Diagnostic {
  SourceLocation where;
  std::string message;   ///< what is wrong, with the value that was found
  std::string expected;  ///< what would have been right; may be empty
  std::string nearest;   ///< the nearest valid name; may be empty

  /// `file:line:column: message; expected ...; did you mean '...'?`
  [[nodiscard]] std::string text() const;
};

/// Bad input of any kind: YAML, scenes, flags, plugins, environment. Carries every diagnostic found, not the first only.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string message);
  explicit Error(Diagnostic diagnostic);
  explicit Error(std::vector<Diagnostic> diagnostics);

  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// The candidate with the least edit distance (Damerau-Levenshtein) to `name`; empty where none is near enough to be meant
/// (more than a third of the longer name's letters differ).
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace raystudy
