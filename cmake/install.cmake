# Installs the executable, the library, its headers and the CMake package that out-of-tree plugins find:
#   find_package(Raystudy REQUIRED)
#   add_library(my_plugin MODULE my_plugin.cpp)
#   target_link_libraries(my_plugin PRIVATE Raystudy::raystudy)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Raystudy)

install(TARGETS raystudy_harness EXPORT RaystudyTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS raystudy_image_codec LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
set_target_properties(raystudy_image_codec PROPERTIES INSTALL_RPATH "$ORIGIN")
install(TARGETS raystudy_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
set_target_properties(raystudy_cli PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/harness DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/raystudy
  FILES_MATCHING PATTERN "*.h" PATTERN "cli" EXCLUDE PATTERN "vega" EXCLUDE)
install(EXPORT RaystudyTargets NAMESPACE Raystudy:: DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/RaystudyConfig.cmake.in ${PROJECT_BINARY_DIR}/RaystudyConfig.cmake
  INSTALL_DESTINATION ${package_dir})
# A plugin must be built for the very version that loads it: roles may change between versions.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/RaystudyConfigVersion.cmake COMPATIBILITY ExactVersion)
install(FILES ${PROJECT_BINARY_DIR}/RaystudyConfig.cmake ${PROJECT_BINARY_DIR}/RaystudyConfigVersion.cmake DESTINATION ${package_dir})
install(FILES ${PROJECT_SOURCE_DIR}/scenes/catalog.yaml DESTINATION ${CMAKE_INSTALL_DATADIR}/raystudy)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/harness/report/vega ${PROJECT_SOURCE_DIR}/results/published DESTINATION ${CMAKE_INSTALL_DATADIR}/raystudy)
