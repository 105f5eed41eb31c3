# Tests read back what was written.
target_link_libraries(harness_report_test PRIVATE PkgConfig::oiio)
