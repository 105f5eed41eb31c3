#include "harness/accel/tree_layout.h"

#include <xxhash.h>

#include <memory>

namespace raystudy::tree_layout {

std::uint64_t checksum(std::span<const std::string_view> parts) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  XXH3_64bits_reset(state.get());
  const auto update = [&state](std::string_view part) { XXH3_64bits_update(state.get(), part.data(), part.size()); };
  constexpr std::size_t place = offsetof(Header, checksum);
  update(parts.front().substr(0, place));
  update(parts.front().substr(place + sizeof(Header::checksum)));
  for (const std::string_view part : parts.subspan(1)) update(part);
  return XXH3_64bits_digest(state.get());
}

}  // namespace raystudy::tree_layout
