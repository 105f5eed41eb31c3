raystudy_shaders(${target} ${CMAKE_CURRENT_SOURCE_DIR}/vulkan/shaders)
