#include "harness/scene/text_cursor.h"

#include <fmt/format.h>

namespace raystudy {

std::string shown(std::string_view word) {
  constexpr std::size_t most = 40;
  std::string text;
  for (const char c : word.substr(0, most)) {
    const auto byte = static_cast<unsigned char>(c);
    text += byte >= 0x20 && byte < 0x7f ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
  }
  return word.size() > most ? text + "…" : text;
}

}  // namespace raystudy
