target_link_libraries(${target} PRIVATE embree)
target_compile_definitions(${target} PRIVATE RAYSTUDY_EMBREE_MAJOR=${embree_VERSION_MAJOR})
