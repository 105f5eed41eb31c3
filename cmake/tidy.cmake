# cmake --build --preset release --target tidy: clang-tidy (Debian package clang-tidy) over harness/, methods/ and scenes/, tests included.
find_program(RUN_CLANG_TIDY run-clang-tidy)
if(RUN_CLANG_TIDY)
  add_custom_target(tidy
    COMMAND ${RUN_CLANG_TIDY} -quiet -p ${PROJECT_BINARY_DIR} "${PROJECT_SOURCE_DIR}/(harness|methods|scenes)/.*"
    USES_TERMINAL COMMENT "clang-tidy on harness, methods and scenes")
endif()
