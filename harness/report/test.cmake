# Tests read back what was written.
target_link_libraries(harness_report_test PRIVATE PkgConfig::oiio)
add_dependencies(harness_report_test raystudy_image_codec)
