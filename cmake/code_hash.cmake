# Run when Raystudy is built: writes OUTPUT, a source that holds one SHA-256 over the files listed in LIST, their names and TOOLCHAIN.
# Results are named by it, so that figures of other code are never taken for those of this one.
file(STRINGS ${LIST} files)
set(text "${TOOLCHAIN}\n")
foreach(file IN LISTS files)
  file(SHA256 ${ROOT}/${file} hash)
  string(APPEND text "${hash} ${file}\n")
endforeach()
string(SHA256 hash "${text}")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include "harness/spec/cell_id.h"

namespace raystudy {
std::string_view code_hash() { return "@hash@"; }
}  // namespace raystudy
]] @ONLY)
