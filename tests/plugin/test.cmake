# The file of CONTRIBUTING.md, compiled into the tests (in-tree) and as an out-of-tree plugin of the installed package.
target_sources(tests_plugin_test PRIVATE ${CMAKE_CURRENT_LIST_DIR}/projected_area.cpp)
set(plugin_flags "")
if(RAYSTUDY_SANITIZE)
  set(plugin_flags -fsanitize=${RAYSTUDY_SANITIZE})
endif()
add_test(NAME tests_plugin.out_of_tree
  COMMAND ${CMAKE_COMMAND} -Dbuild=${PROJECT_BINARY_DIR} -Dsource=${CMAKE_CURRENT_LIST_DIR} -Dcompiler=${CMAKE_CXX_COMPILER}
    -Dflags=${plugin_flags} -P ${CMAKE_CURRENT_LIST_DIR}/out_of_tree.cmake)
