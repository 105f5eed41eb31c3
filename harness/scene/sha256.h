#pragma once

#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace raystudy {

/// SHA-256 of data that arrives piece by piece.
class Sha256 {
 public:
  Sha256();
  void update(std::string_view data);
  /// 64 lower-case hex digits; the object is used up.
  [[nodiscard]] std::string hex();

 private:
  std::shared_ptr<evp_md_ctx_st> context_;
};

[[nodiscard]] std::string sha256_hex(std::string_view data);

}  // namespace raystudy
