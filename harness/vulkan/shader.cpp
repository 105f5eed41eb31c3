#include "harness/vulkan/shader.h"

#include <fmt/format.h>

#include <map>
#include <stdexcept>

namespace raystudy::vulkan {
namespace {

using Shaders = std::map<std::string, std::span<const std::uint32_t>, std::less<>>;

Shaders& shaders() {
  static Shaders all;
  return all;
}

}  // namespace

Shader::Shader(std::string_view name, std::span<const std::uint32_t> code) {
  if (!shaders().emplace(name, code).second) throw std::logic_error(fmt::format("two shaders are called '{}'", name));
}

std::span<const std::uint32_t> shader_code(std::string_view name) {
  const auto found = shaders().find(name);
  if (found == shaders().end()) throw std::logic_error(fmt::format("there is no shader '{}'", name));
  return found->second;
}

std::vector<std::string> shader_names() {
  std::vector<std::string> names;
  for (const auto& [name, code] : shaders()) names.push_back(name);
  return names;
}

}  // namespace raystudy::vulkan
