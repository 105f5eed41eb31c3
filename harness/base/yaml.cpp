#include "harness/base/yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <istream>
#include <map>
#include <streambuf>
#include <system_error>
#include <utility>

#include "harness/base/missing_path.h"

namespace raystudy {
namespace {

/// Builds the tree from yaml-cpp's events. yaml-cpp's own nodes would do but for three things: they let a later duplicate key win
/// in silence, lose the place of keys, and fail on the first problem only.
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(std::string_view text, const std::string& file, std::vector<Diagnostic>& problems)
      : text_(text), file_(file), problems_(problems) {
    line_starts_.push_back(0);
    for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n', end + 1)) {
      line_starts_.push_back(end + 1);
    }
  }

  [[nodiscard]] std::shared_ptr<const YamlNode> root() const { return root_ ? root_ : std::make_shared<YamlNode>(); }
  [[nodiscard]] SourceLocation place(const YAML::Mark& mark) const {
    if (mark.is_null()) return {file_, 0, 0};
    return {file_, mark.line + 1, mark.column + 1};
  }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(make(YamlNode::Kind::null, mark), anchor); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto known = anchors_.find(anchor);
    if (known == anchors_.end()) {
      problems_.push_back({place(mark), "an alias stands inside its own anchor", "an anchor that ends before its alias", {}});
      add(make(YamlNode::Kind::null, mark), YAML::NullAnchor);
      return;
    }
    if (!open_.empty() && open_.back().is_key()) {
      // The entry's place must be the alias's, not the anchor's.
      auto key = std::make_shared<YamlNode>(*known->second);
      key->where = place(mark);
      add(std::move(key), YAML::NullAnchor);
      return;
    }
    add(known->second, YAML::NullAnchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
    auto node = make(YamlNode::Kind::scalar, mark);
    node->text = value;
    node->plain = tag == "?";
    if (!node->plain) require_closing_quote(mark);
    add(std::move(node), anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open_.push_back({make(YamlNode::Kind::list, mark), anchor, {}, {}, false});
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open_.push_back({make(YamlNode::Kind::map, mark), anchor, {}, {}, false});
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    std::shared_ptr<YamlNode> node;
    YAML::anchor_t anchor;
    std::string key;
    SourceLocation key_where;
    bool has_key;
    [[nodiscard]] bool is_key() const { return node->is_map() && !has_key; }
  };

  [[nodiscard]] std::shared_ptr<YamlNode> make(YamlNode::Kind kind, const YAML::Mark& mark) const {
    auto node = std::make_shared<YamlNode>();
    node->kind = kind;
    node->where = place(mark);
    return node;
  }
  void close() {
    Open last = std::move(open_.back());
    open_.pop_back();
    add(std::move(last.node), last.anchor);
  }
  void add(std::shared_ptr<const YamlNode> node, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) anchors_[anchor] = node;
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node->is_list()) {
      parent.node->items.push_back(std::move(node));
    } else if (!parent.has_key) {
      if (!node->is_scalar()) problems_.push_back({node->where, fmt::format("a key is {}", described(*node)), "a text", {}});
      parent.key = node->text;
      parent.key_where = node->where;
      parent.has_key = true;
    } else {
      add_entry(parent, std::move(node));
    }
  }
  void add_entry(Open& parent, std::shared_ptr<const YamlNode> value) {
    parent.has_key = false;
    for (const YamlEntry& entry : parent.node->entries) {
      if (entry.key != parent.key) continue;
      problems_.push_back({parent.key_where,
                           fmt::format("key '{}' stands a second time", parent.key),
                           fmt::format("each key once; the first is on line {}", entry.where.line),
                           {}});
      return;
    }
    parent.node->entries.push_back({parent.key, parent.key_where, std::move(value)});
  }

  /// yaml-cpp 0.7 closes a quote by itself where the file ends in a line break, and all that follows it becomes its text.
  void require_closing_quote(const YAML::Mark& mark) {
    const auto line = static_cast<std::size_t>(mark.line);
    if (mark.is_null() || line >= line_starts_.size()) return;
    std::size_t at = std::min(line_starts_[line] + static_cast<std::size_t>(mark.column), text_.size());
    while (at < text_.size() && (text_[at] == '&' || text_[at] == '!')) {  // an anchor or a tag comes first
      at = text_.find_first_not_of(" \t\r\n", std::min(text_.find_first_of(" \t\r\n", at), text_.size()));
    }
    if (at >= text_.size() || (text_[at] != '\'' && text_[at] != '"')) return;
    const char quote = text_[at];
    const std::string_view stops = quote == '"' ? "\"\\" : "'";
    for (std::size_t stop = text_.find_first_of(stops, at + 1); stop < text_.size(); stop = text_.find_first_of(stops, stop)) {
      const bool pair = text_[stop] == '\\' || (quote == '\'' && text_.substr(stop, 2) == "''");
      if (!pair) return;
      stop += 2;
    }
    problems_.push_back(
        {place(mark), fmt::format("the quote {} is not closed", quote), fmt::format("{} at the text's end", quote), {}});
  }

  std::string_view text_;
  std::vector<std::size_t> line_starts_;
  const std::string& file_;
  std::vector<Diagnostic>& problems_;
  std::shared_ptr<const YamlNode> root_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, std::shared_ptr<const YamlNode>> anchors_;
};

/// A text as a stream, without the copy that istringstream makes.
class TextBuffer final : public std::streambuf {
 public:
  explicit TextBuffer(std::string text) : text_(std::move(text)) {
    setg(text_.data(), text_.data(), text_.data() + text_.size());
  }

 private:
  std::string text_;
};

bool is_number(std::string_view text, bool& is_integer) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const char* end = text.data() + text.size();
  long long integer = 0;
  is_integer = false;
  if (const auto [p, e] = std::from_chars(text.data(), end, integer); e == std::errc{} && p == end) {
    is_integer = true;
    return true;
  }
  double number = 0;
  const auto [p, e] = std::from_chars(text.data(), end, number);
  return e == std::errc{} && p == end && std::isfinite(number);
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  for (const YamlEntry& entry : entries) {
    if (entry.key == key) return entry.value.get();
  }
  return nullptr;
}

std::shared_ptr<const YamlNode> parse_yaml(const std::string& text, const std::string& file, std::vector<Diagnostic>& problems) {
  TreeBuilder builder(text, file, problems);
  try {
    TextBuffer buffer(text);
    std::istream stream(&buffer);
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return builder.root();
    std::shared_ptr<const YamlNode> first = builder.root();
    if (parser.HandleNextDocument(builder)) {
      problems.push_back({builder.root()->where, "a second document begins", "one document a file", {}});
    }
    return first;
  } catch (const YAML::Exception& error) {
    problems.push_back({builder.place(error.mark), "this is no YAML: " + error.msg, {}, {}});
    throw Error(std::move(problems));
  }
}

std::shared_ptr<const YamlNode> read_yaml(const std::string& file, std::vector<Diagnostic>& problems) {
  const auto refuse = [&file](int reason) -> Error {
    const MissingPath missing = reason == ENOENT ? look_around(file, {".yaml", ".yml"}) : MissingPath{};
    const std::string why = missing.absent_folder.empty() ? std::generic_category().message(reason)
                                                          : fmt::format("there is no folder '{}'", missing.absent_folder);
    return Error(Diagnostic{{file, 0, 0}, fmt::format("cannot be read: {}", why), {}, missing.nearest});
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream) throw refuse(errno);
  std::string text;
  char part[65536];
  std::size_t size = 0;
  while ((size = std::fread(part, 1, sizeof part, stream.get())) > 0) text.append(part, size);
  if (std::ferror(stream.get()) != 0) throw refuse(errno);  // e.g. a folder
  return parse_yaml(text, file, problems);
}

std::string described(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null: return "nothing";
    case YamlNode::Kind::list: return "a list";
    case YamlNode::Kind::map: return "a map";
    case YamlNode::Kind::scalar: break;
  }
  if (!node.plain) return fmt::format("the text '{}'", node.text);
  if (node.text == "true" || node.text == "false") return fmt::format("the truth value {}", node.text);
  bool is_integer = false;
  if (is_number(node.text, is_integer)) return fmt::format("the {} {}", is_integer ? "integer" : "number", node.text);
  return fmt::format("the text '{}'", node.text);
}

}  // namespace raystudy
