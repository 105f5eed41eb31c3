# Installs Raystudy into a folder of its own, builds projected_area.cpp there as an out-of-tree plugin, and runs it.
# Arguments: build (Raystudy's build folder), source (this folder), compiler, flags (sanitizers).
set(work ${build}/tests/out-of-tree-plugin)
file(REMOVE_RECURSE ${work})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(failed)
    message(FATAL_ERROR "${ARGN} failed (${failed}):\n${out}")
  endif()
  set(output "${out}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${build} --prefix ${work}/prefix)
file(WRITE ${work}/source/CMakeLists.txt [[
cmake_minimum_required(VERSION 3.25)
project(ProjectedAreaPlugin LANGUAGES CXX)
find_package(Raystudy REQUIRED)
add_library(projected_area MODULE projected_area.cpp)
target_link_libraries(projected_area PRIVATE Raystudy::raystudy)
]])
file(COPY ${source}/projected_area.cpp DESTINATION ${work}/source)
run(${CMAKE_COMMAND} -S ${work}/source -B ${work}/build -G Ninja -DCMAKE_PREFIX_PATH=${work}/prefix
  -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_CXX_FLAGS=${flags})
run(${CMAKE_COMMAND} --build ${work}/build)

set(ENV{RAYSTUDY_PLUGINS} ${work}/build/libprojected_area.so)
run(${work}/prefix/bin/raystudy list)
if(NOT output MATCHES "projected-area [^\n]*libprojected_area.so")
  message(FATAL_ERROR "the plugin's heuristic is not listed:\n${output}")
endif()

# The study of CONTRIBUTING.md, run with the plugin.
run(${work}/prefix/bin/raystudy run ${source}/my-study.yaml --results ${work}/results)
if(NOT output MATCHES "\\| sun +\\| +[0-9.]+ \\|" OR NOT output MATCHES "0 failed")
  message(FATAL_ERROR "the study with the plugin's heuristic has no row of it:\n${output}")
endif()

# The same file twice under two names: two plugins of one name.
file(COPY_FILE ${work}/build/libprojected_area.so ${work}/build/libsecond.so)
set(ENV{RAYSTUDY_PLUGINS} ${work}/build/libprojected_area.so:${work}/build/libsecond.so)
execute_process(COMMAND ${work}/prefix/bin/raystudy list RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE out)
if(NOT status EQUAL 2 OR NOT out MATCHES "two plugins register the heuristic 'projected-area': one from [^ ]*libprojected_area.so, one from [^ ]*libsecond.so")
  message(FATAL_ERROR "two plugins of one name gave status ${status}:\n${out}")
endif()
