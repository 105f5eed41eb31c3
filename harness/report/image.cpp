#include "harness/report/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace raystudy {
namespace {

constexpr const char* font = "DejaVuSans";

/// The curve of IEC 61966-2-1 for one channel.
float srgb(float linear) {
  const float x = std::clamp(linear, 0.0F, 1.0F);
  return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F;
}

std::string extension_of(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  if (extension != ".png" && extension != ".exr") {
    throw Error(Diagnostic{{}, fmt::format("cannot write '{}' as an image", file.string()), "a name ending in .png or .exr", {}});
  }
  return extension;
}

/// The file's bytes, encoded in memory: the encoders report a full disk badly, our own writing does not.
std::string encoded(const Image& image, const std::string& extension) {
  const bool png = extension == ".png";
  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()),
                       png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
  spec.channelnames = image.channels;
  spec.attribute("oiio:ColorSpace", png ? "sRGB" : "Linear");
  spec.attribute("compression", "zip");  // of EXR
  spec.attribute("png:compressionLevel", 9);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create("memory" + extension, &memory);
  bool good = out != nullptr && out->open("memory" + extension, spec);
  if (good && png) {
    std::vector<unsigned char> values(image.pixels.size());
    std::transform(image.pixels.begin(), image.pixels.end(), values.begin(),
                   [](float x) { return static_cast<unsigned char>(255 * srgb(x) + 0.5F); });
    good = out->write_image(OIIO::TypeDesc::UINT8, values.data());
  } else if (good) {
    good = out->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data());
  }
  if (!good || !out->close()) {
    throw Error(fmt::format("cannot encode an image as {}: {}", extension, out ? out->geterror() : OIIO::geterror()));
  }
  return {bytes.begin(), bytes.end()};
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

OIIO::ROI text_extent(const std::string& text, int size) {
  const OIIO::ROI roi = OIIO::ImageBufAlgo::text_size(text, size, font);
  if (!roi.defined()) {
    throw Error(fmt::format("cannot draw text: {} (the font is in Debian's package fonts-dejavu-core)", OIIO::geterror()));
  }
  return roi;
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
  text_extent(text, size);  // throws where there is no font
  const OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()), OIIO::TypeDesc::FLOAT);
  OIIO::ImageBuf buffer(spec, image.pixels.data());  // works on our pixels
  const auto align_x = align == TextAlign::left    ? OIIO::ImageBufAlgo::TextAlignX::Left
                       : align == TextAlign::right ? OIIO::ImageBufAlgo::TextAlignX::Right
                                                   : OIIO::ImageBufAlgo::TextAlignX::Center;
  const std::array<float, 3> ink{color.x, color.y, color.z};
  // The middle of a line is 0.36 sizes above its baseline, whatever letters it holds.
  if (!OIIO::ImageBufAlgo::render_text(buffer, x, y + static_cast<int>(0.36F * static_cast<float>(size)), text, size, font, ink,
                                       align_x, OIIO::ImageBufAlgo::TextAlignY::Baseline)) {
    throw Error(fmt::format("cannot draw text: {}", buffer.geterror()));
  }
}

int text_width(const std::string& text, int size) { return text_extent(text, size).width(); }

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
  write_file_atomically(file, encoded(to_map ? tone_mapped(image) : image, extension));
}

}  // namespace raystudy
