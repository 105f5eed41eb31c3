#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace raystudy {

/// A read-only array that shares its storage: a vector it took over, or a part of a memory-mapped file it keeps open.
template <class T>
class SharedArray {
 public:
  SharedArray() = default;
  explicit SharedArray(std::vector<T> values) {
    auto owned = std::make_shared<const std::vector<T>>(std::move(values));
    view_ = *owned;
    keep_ = std::move(owned);
  }
  SharedArray(std::shared_ptr<const void> keep, std::span<const T> view) : keep_(std::move(keep)), view_(view) {}

  [[nodiscard]] std::size_t size() const { return view_.size(); }
  [[nodiscard]] bool empty() const { return view_.empty(); }
  [[nodiscard]] const T* data() const { return view_.data(); }
  [[nodiscard]] const T& operator[](std::size_t i) const { return view_[i]; }
  [[nodiscard]] auto begin() const { return view_.begin(); }
  [[nodiscard]] auto end() const { return view_.end(); }
  operator std::span<const T>() const { return view_; }  // NOLINT(google-explicit-constructor): it is a span that owns

 private:
  std::shared_ptr<const void> keep_;
  std::span<const T> view_;
};

}  // namespace raystudy
