#include "harness/spec/formula.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "harness/base/error.h"

namespace raystudy {

struct Formula::Node {
  char operation = '#';  ///< '#' a number, 'a' a name, '~' unary minus, else + - * /
  double number = 0;
  std::string name;
  std::unique_ptr<Node> left;
  std::unique_ptr<Node> right;
};

namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Recursive descent: sum → product → factor.
class FormulaParser {
 public:
  using Node = Formula::Node;
  FormulaParser(std::string_view text, std::vector<std::string>& names) : text_(text), names_(names) {}

  std::unique_ptr<Node> parse() {
    auto node = sum();
    if (next() != '\0') refuse("the end, or one of + - * /");
    return node;
  }

 private:
  // Trees of formulas are walked recursively.
  static constexpr int most_depth = 200;
  static constexpr int most_length = 1000;

  char next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t')) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  [[noreturn]] void refuse(std::string_view expected) {
    const std::string found =
        at_ < text_.size() ? fmt::format("'{}' stands at letter {}", text_[at_], at_ + 1) : "it ends too early";
    throw Error(Diagnostic{{}, fmt::format("formula '{}': {}", text_, found), std::string(expected), {}});
  }
  static std::unique_ptr<Node> join(char operation, std::unique_ptr<Node> left, std::unique_ptr<Node> right) {
    auto node = std::make_unique<Node>();
    node->operation = operation;
    node->left = std::move(left);
    node->right = std::move(right);
    return node;
  }
  /// Chains left to right: a - b - c is (a - b) - c.
  template <class Part>
  std::unique_ptr<Node> chain(char one, char other, Part part) {
    auto node = part();
    for (char c = next(); c == one || c == other; c = next()) {
      if (++length_ > most_length) refuse(fmt::format("at most {} operations", most_length));
      ++at_;
      node = join(c, std::move(node), part());
    }
    return node;
  }
  std::unique_ptr<Node> sum() {
    return chain('+', '-', [this] { return product(); });
  }
  std::unique_ptr<Node> product() {
    return chain('*', '/', [this] { return factor(); });
  }
  std::unique_ptr<Node> factor() {
    if (++depth_ > most_depth) refuse(fmt::format("at most {} parentheses inside each other", most_depth));
    std::unique_ptr<Node> node;
    const char c = next();
    if (c == '-') {
      ++at_;
      node = join('~', factor(), nullptr);
    } else if (c == '(') {
      ++at_;
      node = sum();
      if (next() != ')') refuse("')'");
      ++at_;
    } else if (is_letter(c)) {
      node = name();
    } else {
      node = number();
    }
    --depth_;
    return node;
  }
  std::unique_ptr<Node> name() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    auto node = std::make_unique<Node>();
    node->operation = 'a';
    node->name = text_.substr(begin, at_ - begin);
    if (std::find(names_.begin(), names_.end(), node->name) == names_.end()) names_.push_back(node->name);
    return node;
  }
  std::unique_ptr<Node> number() {
    auto node = std::make_unique<Node>();
    const char* begin = text_.data() + at_;
    const auto [stop, error] = std::from_chars(begin, text_.data() + text_.size(), node->number);
    if (error != std::errc{} || !(is_digit(*begin) || *begin == '.')) refuse("a number, a column's name or '('");
    at_ += static_cast<std::size_t>(stop - begin);
    return node;
  }

  std::string_view text_;
  std::vector<std::string>& names_;
  std::size_t at_ = 0;
  int depth_ = 0;
  int length_ = 0;
};

double value_of_node(const Formula::Node& node, const std::function<double(std::string_view)>& value_of) {
  switch (node.operation) {
    case '#': return node.number;
    case 'a': return value_of(node.name);
    case '~': return -value_of_node(*node.left, value_of);
    default: break;
  }
  const double left = value_of_node(*node.left, value_of);
  const double right = value_of_node(*node.right, value_of);
  switch (node.operation) {
    case '+': return left + right;
    case '-': return left - right;
    case '*': return left * right;
    default: return left / right;
  }
}

}  // namespace

Formula::Formula(std::string_view text) : root_(FormulaParser(text, names_).parse()) {}
Formula::~Formula() = default;
Formula::Formula(Formula&&) noexcept = default;
Formula& Formula::operator=(Formula&&) noexcept = default;

double Formula::evaluate(const std::function<double(std::string_view)>& value_of) const {
  return value_of_node(*root_, value_of);
}

bool is_formula_name(std::string_view name) {
  return !name.empty() && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [](char c) { return is_letter(c) || is_digit(c); });
}

}  // namespace raystudy
