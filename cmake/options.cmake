# Flags of every target in this project; not passed on to plugins that use the installed package.
add_library(raystudy_flags INTERFACE)
target_compile_options(raystudy_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror
  # GCC 12 raises these two falsely on std::string in optimized code (GCC bugs 105562 and 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-restrict>
  # Fused multiply-adds only where the code says fma: otherwise the edge functions of two triangles that share an edge round
  # differently and rays slip through, and costs differ between processors.
  -ffp-contract=off
  -fno-math-errno -fno-semantic-interposition)
# SIMD (Highway) for the instruction set that the rest is compiled for; no choice at run time.
target_compile_definitions(raystudy_flags INTERFACE HWY_COMPILE_ONLY_STATIC)
if(RAYSTUDY_NATIVE)
  target_compile_options(raystudy_flags INTERFACE -march=native)
elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  target_compile_options(raystudy_flags INTERFACE -march=x86-64-v2)  # SSE 4.2: the least that Highway 1.0.3 has vectors for
endif()
if(RAYSTUDY_SANITIZE)
  target_compile_options(raystudy_flags INTERFACE -fsanitize=${RAYSTUDY_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(raystudy_flags INTERFACE -fsanitize=${RAYSTUDY_SANITIZE})
endif()
