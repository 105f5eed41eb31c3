// PLY: ASCII and both binary byte orders, any property types, extra elements and properties skipped, polygons cut into fans.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <utility>

#include "harness/scene/source.h"
#include "harness/scene/text_cursor.h"

namespace raystudy {
namespace {

enum class Type : unsigned char { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Type type = Type::float32;
  bool is_list = false;
  Type count_type = Type::uint8;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding : unsigned char { none, ascii, little, big };

struct Header {
  Encoding encoding = Encoding::none;
  std::vector<Element> elements;
  std::size_t end = 0;  ///< offset of the data
  int lines = 0;
};

constexpr std::array<std::pair<std::string_view, Type>, 16> type_names{{{"char", Type::int8},
                                                                        {"int8", Type::int8},
                                                                        {"uchar", Type::uint8},
                                                                        {"uint8", Type::uint8},
                                                                        {"short", Type::int16},
                                                                        {"int16", Type::int16},
                                                                        {"ushort", Type::uint16},
                                                                        {"uint16", Type::uint16},
                                                                        {"int", Type::int32},
                                                                        {"int32", Type::int32},
                                                                        {"uint", Type::uint32},
                                                                        {"uint32", Type::uint32},
                                                                        {"float", Type::float32},
                                                                        {"float32", Type::float32},
                                                                        {"double", Type::float64},
                                                                        {"float64", Type::float64}}};

constexpr std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}
constexpr bool is_integer(Type type) { return type < Type::float32; }

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return words;
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

class HeaderParser {
 public:
  explicit HeaderParser(const SourceFile& source) : source_(source), text_(as_text(source.bytes)) {}

  Header parse() {
    if (next_line() != "ply") fail("the file does not begin with 'ply'", "a PLY file");
    while (true) {
      const auto words = words_of(next_line());
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      statement(words);
    }
    if (header_.encoding == Encoding::none) {
      fail("the header has no 'format' line", "format ascii, binary_little_endian or binary_big_endian");
    }
    header_.end = position_;
    header_.lines = line_;
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(std::string message, std::string expected) const {
    fail_at(source_.name, std::move(message), std::move(expected), line_);
  }

  std::string_view next_line() {
    ++line_;
    const std::size_t end = text_.find('\n', position_);
    if (end == std::string_view::npos) fail("the header ends without 'end_header'", "a complete PLY header");
    std::string_view line = text_.substr(position_, end - position_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    position_ = end + 1;
    return line;
  }

  void statement(const std::vector<std::string_view>& words) {
    if (words[0] == "format" && words.size() == 3) {
      if (words[1] == "ascii") {
        header_.encoding = Encoding::ascii;
      } else if (words[1] == "binary_little_endian") {
        header_.encoding = Encoding::little;
      } else if (words[1] == "binary_big_endian") {
        header_.encoding = Encoding::big;
      } else {
        fail(fmt::format("unknown format '{}'", words[1]), "ascii, binary_little_endian or binary_big_endian");
      }
    } else if (words[0] == "element" && words.size() == 3) {
      Element element{std::string(words[1]), 0, {}};
      const auto [end, error] = std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
      if (error != std::errc{} || end != words[2].data() + words[2].size()) {
        fail(fmt::format("element '{}' has the count '{}'", words[1], words[2]), "a whole number");
      }
      header_.elements.push_back(std::move(element));
    } else if (words[0] == "property" && !header_.elements.empty() && words.size() == 3) {
      header_.elements.back().properties.push_back({std::string(words[2]), type(words[1])});
    } else if (words[0] == "property" && !header_.elements.empty() && words.size() == 5 && words[1] == "list") {
      const Type count_type = type(words[2]);
      if (!is_integer(count_type)) {
        fail(fmt::format("the list '{}' has a count of type '{}'", words[4], words[2]), "an integer type");
      }
      header_.elements.back().properties.push_back({std::string(words[4]), type(words[3]), true, count_type});
    } else {
      fail(fmt::format("the header line '{}' is not understood", shown(fmt::format("{}", fmt::join(words, " ")))),
           "format, element, property, comment or end_header");
    }
  }

  [[nodiscard]] Type type(std::string_view word) const {
    for (const auto& [name, t] : type_names) {
      if (name == word) return t;
    }
    std::vector<std::string> known;
    known.reserve(type_names.size());
    for (const auto& [name, t] : type_names) known.emplace_back(name);
    throw Error(Diagnostic{
        {source_.name, line_, 0}, fmt::format("unknown property type '{}'", word), "a PLY type", nearest_name(word, known)});
  }

  const SourceFile& source_;
  std::string_view text_;
  std::size_t position_ = 0;
  int line_ = 0;
  Header header_;
};

/// Values of a binary body, one after the other.
template <bool swap>
class BinaryCursor {
 public:
  BinaryCursor(const SourceFile& source, const Header& header)
      : source_(source), p_(source.bytes.data() + header.end), end_(source.bytes.data() + source.bytes.size()) {}

  [[nodiscard]] std::size_t most_records(std::size_t bytes_each) const {
    return static_cast<std::size_t>(end_ - p_) / std::max<std::size_t>(bytes_each, 1);
  }
  static std::size_t least_size(Type type) { return size_of(type); }
  void skip_to_end() { p_ = end_; }

  double real(Type type) {
    switch (type) {
      case Type::float32: return static_cast<double>(std::bit_cast<float>(take<std::uint32_t>()));
      case Type::float64: return std::bit_cast<double>(take<std::uint64_t>());
      default: return static_cast<double>(integer(type));
    }
  }
  std::int64_t integer(Type type) {
    switch (type) {
      case Type::int8: return static_cast<std::int8_t>(take<std::uint8_t>());
      case Type::uint8: return take<std::uint8_t>();
      case Type::int16: return static_cast<std::int16_t>(take<std::uint16_t>());
      case Type::uint16: return take<std::uint16_t>();
      case Type::int32: return static_cast<std::int32_t>(take<std::uint32_t>());
      case Type::uint32: return take<std::uint32_t>();
      default: break;
    }
    return static_cast<std::int64_t>(real(type));
  }
  [[noreturn]] void fail(std::string message, std::string expected) const {
    fail_at(source_.name, fmt::format("{} (before byte {})", message, p_ - source_.bytes.data()), std::move(expected));
  }
  [[noreturn]] void fail_short(std::string_view element, std::size_t done, std::size_t count) const {
    fail_at(source_.name, fmt::format("the file ends at {} {} of {}", element, done, count), "a complete file");
  }
  void begin_record(std::string_view element, std::size_t index, std::size_t count) {
    element_ = element;
    index_ = index;
    count_ = count;
  }

 private:
  template <class T>
  T take() {
    if (static_cast<std::size_t>(end_ - p_) < sizeof(T)) fail_short(element_, index_, count_);
    T value;
    std::memcpy(&value, p_, sizeof value);
    p_ += sizeof value;
    if constexpr (swap && sizeof(T) == 2) value = __builtin_bswap16(value);
    if constexpr (swap && sizeof(T) == 4) value = __builtin_bswap32(value);
    if constexpr (swap && sizeof(T) == 8) value = __builtin_bswap64(value);
    return value;
  }

  const SourceFile& source_;
  const char* p_;
  const char* end_;
  std::string_view element_;
  std::size_t index_ = 0;
  std::size_t count_ = 0;
};

/// Values of an ASCII body.
class AsciiCursor {
 public:
  AsciiCursor(const SourceFile& source, const Header& header) : cursor_(source, header.end, header.lines + 1) {}

  [[nodiscard]] std::size_t most_records(std::size_t bytes_each) const {
    return (cursor_.bytes_left() + 1) / std::max<std::size_t>(bytes_each, 1);
  }
  static std::size_t least_size(Type /*type*/) { return 2; }  // a digit and white space
  void skip_to_end() {
    while (!cursor_.next_word().empty()) {
    }
  }

  double real(Type type) {
    const std::string_view word = next_word();
    if (type != Type::float64) {
      // Straight to float: by way of double, a few decimals would round twice.
      float value = 0;
      if (TextCursor::parse(word, value)) return static_cast<double>(value);
    } else {
      double value = 0;
      if (TextCursor::parse(word, value)) return value;
    }
    fail(fmt::format("'{}' stands where a number should", shown(word)), "a number");
  }
  std::int64_t integer(Type /*type*/) {
    const std::string_view word = next_word();
    std::int64_t value = 0;
    if (!TextCursor::parse(word, value)) {
      fail(fmt::format("'{}' stands where an index or count should", shown(word)), "a whole number");
    }
    return value;
  }
  [[noreturn]] void fail(std::string message, std::string expected) const {
    cursor_.fail(std::move(message), std::move(expected));
  }
  [[noreturn]] void fail_short(std::string_view element, std::size_t done, std::size_t count) const {
    cursor_.fail(fmt::format("the file ends at {} {} of {}", element, done, count), "a complete file");
  }
  void begin_record(std::string_view element, std::size_t index, std::size_t count) {
    element_ = element;
    index_ = index;
    count_ = count;
  }

 private:
  std::string_view next_word() {
    const std::string_view word = cursor_.next_word();
    if (word.empty()) fail_short(element_, index_, count_);
    return word;
  }

  TextCursor cursor_;
  std::string_view element_;
  std::size_t index_ = 0;
  std::size_t count_ = 0;
};

template <class Cursor>
class BodyReader {
 public:
  BodyReader(const SourceFile& source, const Header& header) : source_(source), header_(header), cursor_(source, header) {}

  Scene read() {
    for (const Element& element : header_.elements) {
      // A damaged count must not make us reserve memory that the file cannot fill.
      std::size_t bytes_each = 0;
      for (const Property& p : element.properties) bytes_each += Cursor::least_size(p.is_list ? p.count_type : p.type);
      if (const std::size_t most = cursor_.most_records(bytes_each); element.count > most) {
        cursor_.skip_to_end();
        cursor_.fail_short(element.name, most, element.count);
      }
      if (element.properties.empty()) continue;
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else {
        skip(element);
      }
    }
    Scene scene;  // faces may stand before the vertices: finish_scene checks the indices
    scene.vertices = SharedArray<Vec3>(std::move(vertices_));
    scene.triangles = SharedArray<Triangle>(std::move(triangles_));
    return scene;
  }

 private:
  void skip_property(const Property& p) {
    const std::int64_t n = p.is_list ? cursor_.integer(p.count_type) : 1;
    for (std::int64_t i = 0; i < n; ++i) (void)cursor_.real(p.type);
  }
  void skip(const Element& element) {
    for (std::size_t i = 0; i < element.count; ++i) {
      cursor_.begin_record(element.name, i, element.count);
      for (const Property& p : element.properties) skip_property(p);
    }
  }

  void read_vertices(const Element& element) {
    std::vector<int> axis_of;
    int found = 0;
    for (const Property& p : element.properties) {
      const int axis = p.is_list ? -1 : p.name == "x" ? 0 : p.name == "y" ? 1 : p.name == "z" ? 2 : -1;
      axis_of.push_back(axis);
      if (axis >= 0) found |= 1 << axis;
    }
    if (found != 7) fail_at(source_.name, "the vertices have no x, y and z", "'property float x' and so on in the header");
    vertices_.resize(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
      cursor_.begin_record(element.name, i, element.count);
      for (std::size_t k = 0; k < axis_of.size(); ++k) {
        if (axis_of[k] < 0) {
          skip_property(element.properties[k]);
        } else {
          vertices_[i][axis_of[k]] = static_cast<float>(cursor_.real(element.properties[k].type));
        }
      }
    }
  }

  static bool is_corner_list(const Property& p) { return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index"); }

  void read_faces(const Element& element) {
    const auto corners = std::find_if(element.properties.begin(), element.properties.end(), is_corner_list);
    if (corners == element.properties.end() || !is_integer(corners->type)) {
      fail_at(source_.name, "the faces have no list of vertex indices", "'property list uchar int vertex_indices' in the header");
    }
    triangles_.reserve(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
      cursor_.begin_record(element.name, i, element.count);
      for (const Property& p : element.properties) {
        if (&p == &*corners) {
          read_face(p, i);
        } else {
          skip_property(p);
        }
      }
    }
  }

  void read_face(const Property& p, std::size_t face) {
    const std::int64_t n = cursor_.integer(p.count_type);
    if (n < 3) cursor_.fail(fmt::format("face {} has {} corners", face, n), "3 or more");
    const std::uint32_t first = corner(p, face);
    std::uint32_t last = corner(p, face);
    for (std::int64_t k = 2; k < n; ++k) {
      const std::uint32_t next = corner(p, face);
      triangles_.push_back({{first, last, next}});
      last = next;
    }
  }

  std::uint32_t corner(const Property& p, std::size_t face) {
    const std::int64_t index = cursor_.integer(p.type);
    if (index < 0 || index > 0xffffffffLL) {
      cursor_.fail(fmt::format("face {} refers to vertex {}", face, index), "an index from 0 on");
    }
    return static_cast<std::uint32_t>(index);
  }

  const SourceFile& source_;
  const Header& header_;
  Cursor cursor_;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
};

}  // namespace

Scene read_ply(const SourceFile& source) {
  static_assert(std::endian::native == std::endian::little);
  const Header header = HeaderParser(source).parse();
  if (header.encoding == Encoding::ascii) return BodyReader<AsciiCursor>(source, header).read();
  if (header.encoding == Encoding::little) return BodyReader<BinaryCursor<false>>(source, header).read();
  return BodyReader<BinaryCursor<true>>(source, header).read();
}

}  // namespace raystudy
