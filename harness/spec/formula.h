#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace raystudy {

/// An expression over a table's columns: numbers, names (letters, digits and '_', not beginning with a digit), + - * /, unary
/// minus and parentheses, with the usual precedence.
class Formula {
 public:
  /// Throws Error that says what stands where in the text, counting letters from 1.
  explicit Formula(std::string_view text);
  ~Formula();
  Formula(Formula&&) noexcept;
  Formula& operator=(Formula&&) noexcept;
  Formula(const Formula&) = delete;
  Formula& operator=(const Formula&) = delete;

  /// Every name once, in the order of the text.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// `value_of` gives each name's value; not-a-number passes through, a division by zero is infinite.
  [[nodiscard]] double evaluate(const std::function<double(std::string_view)>& value_of) const;

  struct Node;

 private:
  std::vector<std::string> names_;  // before root_, whose making fills it
  std::unique_ptr<Node> root_;
};

/// True for a name that a formula can hold.
[[nodiscard]] bool is_formula_name(std::string_view name);

}  // namespace raystudy
