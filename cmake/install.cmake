# Installs the library, its headers and the CMake package that out-of-tree plugins find.
