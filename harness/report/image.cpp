#include "harness/report/image.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/report/codec/image_codec.h"

namespace raystudy {
namespace {

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  if (extension != ".png" && extension != ".exr") {
    throw Error(Diagnostic{{}, fmt::format("cannot write '{}' as an image", file.string()), "a name ending in .png or .exr", {}});
  }
  return extension;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

/// The codec's library beside our own, loaded when the first image is made: OpenImageIO brings some 250 libraries, and starting
/// every command with them would cost half a second.
const ImageCodec& image_codec() {
  static const ImageCodec& codec = [&]() -> const ImageCodec& {
    Dl_info here{};
    if (dladdr(reinterpret_cast<const void*>(&filled_image), &here) == 0) {
      throw std::logic_error("dladdr does not know this library");
    }
    const std::filesystem::path file = std::filesystem::path(here.dli_fname).parent_path() / image_codec_library;
    void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* entry = library == nullptr ? nullptr : dlsym(library, image_codec_entry);
    if (entry == nullptr) {
      const char* reason = dlerror();
      throw Error(
          fmt::format("cannot load the image codec '{}': {}", file.string(), reason != nullptr ? reason : "unknown reason"));
    }
    return *reinterpret_cast<ImageCodecEntry*>(entry)();
  }();
  return codec;
}

}  // namespace

Image filled_image(int width, int height, Vec3 color) {
  Image image{.width = width, .height = height};
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = color[static_cast<int>(i % 3)];
  return image;
}

Image tone_mapped(const Image& radiance, float exposure) {
  if (radiance.kind != ImageKind::radiance) throw std::logic_error("tone_mapped: not an image of radiance");
  Image result = radiance;
  result.kind = ImageKind::color;
  for (float& value : result.pixels) {
    const float x = std::max(0.0F, 0.6F * exposure * value);  // 0.6: the curve's own pre-exposure
    value = std::min(1.0F, x * (2.51F * x + 0.03F) / (x * (2.43F * x + 0.59F) + 0.14F));
  }
  return result;
}

void draw_text(Image& image, int x, int y, const std::string& text, int size, Vec3 color, TextAlign align) {
  image_codec().draw_text(image, x, y, text, size, color, align);
}

int text_width(const std::string& text, int size) { return image_codec().text_width(text, size); }

Image side_by_side(std::span<const Image> images, std::span<const std::string> labels, int gap) {
  if (images.empty()) throw std::logic_error("side_by_side: no images");
  if (!labels.empty() && labels.size() != images.size()) throw std::logic_error("side_by_side: as many labels as images");
  const int height = images.front().height;
  int width = gap * static_cast<int>(images.size() - 1);
  for (const Image& image : images) {
    if (image.height != height || image.channels.size() != 3) throw std::logic_error("side_by_side: images of one height");
    width += image.width;
  }
  const int text = std::clamp(height / 24, 11, 24);
  const int top = labels.empty() ? 0 : 2 * text;
  Image result = filled_image(width, height + top, Vec3{1});
  int left = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Image shown = images[i].kind == ImageKind::radiance ? tone_mapped(images[i]) : images[i];
    for (int y = 0; y < height; ++y) std::copy_n(shown.at(0, y), std::size_t{3} * shown.width, result.at(left, y + top));
    if (!labels.empty()) draw_text(result, left + shown.width / 2, text, labels[i], text, Vec3{0}, TextAlign::center);
    left += shown.width + gap;
  }
  return result;
}

void require_writable_image(const std::filesystem::path& file) {
  extension_of(file);
  require_writable_folder(folder_of(file));
}

void write_image(const std::filesystem::path& file, const Image& image) {
  const std::string extension = extension_of(file);
  if (extension == ".png" && image.kind == ImageKind::data) throw std::logic_error("write_image: data cannot be shown as PNG");
  const bool to_map = extension == ".png" && image.kind == ImageKind::radiance;
  write_file_atomically(file, image_codec().encoded(to_map ? tone_mapped(image) : image, extension));
}

}  // namespace raystudy
