#pragma once

#include <string>

#include "harness/report/image.h"

namespace raystudy {

/// What needs OpenImageIO, in a library of its own that image.cpp loads when the first image is made.
class ImageCodec {
 public:
  ImageCodec() = default;
  ImageCodec(const ImageCodec&) = delete;
  ImageCodec& operator=(const ImageCodec&) = delete;
  virtual ~ImageCodec() = default;

  /// The bytes of a file with the extension .png or .exr. Throws Error with what the encoder says.
  [[nodiscard]] virtual std::string encoded(const Image& image, const std::string& extension) const = 0;
  /// As the functions of image.h.
  virtual void draw_text(Image& image, int x, int y, const std::string& text, int size, Vec3 color, TextAlign align) const = 0;
  [[nodiscard]] virtual int text_width(const std::string& text, int size) const = 0;
};

inline constexpr const char* image_codec_library = "libraystudy_image_codec.so";
inline constexpr const char* image_codec_entry = "raystudy_image_codec";
using ImageCodecEntry = const ImageCodec*();

}  // namespace raystudy
