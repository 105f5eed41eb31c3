#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raystudy::vulkan {

/// SPIR-V code that the build compiled and embedded (cmake/shaders.cmake), known by its file's name without ".comp". A static
/// object of this, in the generated source, makes it known.
struct Shader {
  Shader(std::string_view name, std::span<const std::uint32_t> code);
};

/// Throws std::logic_error for a name that was not embedded.
[[nodiscard]] std::span<const std::uint32_t> shader_code(std::string_view name);
[[nodiscard]] std::vector<std::string> shader_names();

}  // namespace raystudy::vulkan
