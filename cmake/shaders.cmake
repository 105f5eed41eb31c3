# raystudy_shaders(target folder): compiles folder/*.comp (GLSL; *.glsl are included by them) to SPIR-V for Vulkan 1.2, optimized and
# validated, and embeds the code in `target`, where harness/vulkan/shader.h finds it by the file's name.
find_program(GLSLC glslc REQUIRED)
find_program(SPIRV_VAL spirv-val REQUIRED)

function(raystudy_shaders target folder)
  file(GLOB shaders CONFIGURE_DEPENDS ${folder}/*.comp)
  set(output_folder ${CMAKE_CURRENT_BINARY_DIR}/${target}_shaders)
  file(MAKE_DIRECTORY ${output_folder})
  set(includes "")
  set(objects "")
  foreach(shader IN LISTS shaders)
    cmake_path(GET shader STEM name)
    set(spv ${output_folder}/${name}.spv)
    set(words ${output_folder}/${name}.inc)
    set(compile ${GLSLC} --target-env=vulkan1.2 -O -Werror -I ${PROJECT_SOURCE_DIR} -I ${folder} ${shader})
    add_custom_command(OUTPUT ${spv} ${words}
      COMMAND ${compile} -MD -MF ${spv}.d -o ${spv}
      COMMAND ${SPIRV_VAL} --target-env vulkan1.2 --scalar-block-layout ${spv}
      COMMAND ${compile} -mfmt=c -o ${words}
      DEPENDS ${shader} DEPFILE ${spv}.d COMMENT "Compiling shader ${name}" VERBATIM)
    list(APPEND inputs ${words})
    string(MAKE_C_IDENTIFIER ${name} symbol)
    string(APPEND objects "constexpr std::uint32_t ${symbol}_code[] =\n#include \"${words}\"\n    ;\nconst Shader ${symbol}(\"${name}\", ${symbol}_code);\n")
  endforeach()
  file(CONFIGURE OUTPUT ${output_folder}/shaders.cpp @ONLY CONTENT [[
#include "harness/vulkan/shader.h"

namespace raystudy::vulkan {
namespace {
@objects@
}  // namespace
}  // namespace raystudy::vulkan
]])
  set_source_files_properties(${output_folder}/shaders.cpp PROPERTIES OBJECT_DEPENDS "${inputs}")
  target_sources(${target} PRIVATE ${output_folder}/shaders.cpp)
endfunction()
