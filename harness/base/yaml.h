#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/error.h"

namespace raystudy {

struct YamlEntry;

/// A node of a YAML document that knows where it stands. Aliases share the node of their anchor.
struct YamlNode {
  enum class Kind : unsigned char { null, scalar, list, map };

  Kind kind = Kind::null;
  std::string text;    ///< of a scalar
  bool plain = false;  ///< a scalar without quotes: it may be a number or a truth value
  std::vector<std::shared_ptr<const YamlNode>> items;
  std::vector<YamlEntry> entries;  ///< of a map, in the order of the file, without keys that stood before
  SourceLocation where;

  [[nodiscard]] bool is_null() const { return kind == Kind::null; }
  [[nodiscard]] bool is_scalar() const { return kind == Kind::scalar; }
  [[nodiscard]] bool is_list() const { return kind == Kind::list; }
  [[nodiscard]] bool is_map() const { return kind == Kind::map; }
  /// The value of `key` in a map, or null.
  [[nodiscard]] const YamlNode* find(std::string_view key) const;
};

struct YamlEntry {
  std::string key;
  SourceLocation where;  ///< of the key
  std::shared_ptr<const YamlNode> value;
};

/// Parses one document. Duplicate keys, keys that are no text and a second document are added to `problems`; the rest is still
/// returned. Throws Error with line and column where the text is no YAML. An empty text is a null node.
[[nodiscard]] std::shared_ptr<const YamlNode> parse_yaml(const std::string& text, const std::string& file,
                                                         std::vector<Diagnostic>& problems);
/// Reads and parses a file. Throws Error naming the file and the system's reason where it cannot be read, and the nearest name of
/// one that is not there.
[[nodiscard]] std::shared_ptr<const YamlNode> read_yaml(const std::string& file, std::vector<Diagnostic>& problems);

/// What a user would call it: "the text 'abc'", "the number 2.5", "a list", "nothing".
[[nodiscard]] std::string described(const YamlNode& node);

}  // namespace raystudy
