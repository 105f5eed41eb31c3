# Highway's library finds out at run time what the processor can do.
target_link_libraries(${target} PRIVATE PkgConfig::hwy)
