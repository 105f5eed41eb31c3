#pragma once

#include "harness/base/error.h"

namespace raystudy {

/// What is asked for is right, but this build or this machine lacks what it needs: a library's version, an instruction set.
class Unsupported : public Error {
 public:
  using Error::Error;
};

}  // namespace raystudy
