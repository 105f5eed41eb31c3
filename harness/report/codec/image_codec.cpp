#include "harness/report/codec/image_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "harness/base/error.h"

namespace raystudy {
namespace {

constexpr const char* font = "DejaVuSans";

/// The curve of IEC 61966-2-1 for one channel.
float srgb(float linear) {
  const float x = std::clamp(linear, 0.0F, 1.0F);
  return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F;
}

OIIO::ROI text_extent(const std::string& text, int size) {
  const OIIO::ROI roi = OIIO::ImageBufAlgo::text_size(text, size, font);
  if (!roi.defined()) {
    throw Error(fmt::format("cannot draw text: {} (the font is in Debian's package fonts-dejavu-core)", OIIO::geterror()));
  }
  return roi;
}

class OpenImageIoCodec final : public ImageCodec {
 public:
  /// The file's bytes, encoded in memory: the encoders report a full disk badly, our own writing does not.
  [[nodiscard]] std::string encoded(const Image& image, const std::string& extension) const override {
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
                     [](float x) { return static_cast<unsigned char>(std::lround(255 * srgb(x))); });
      good = out->write_image(OIIO::TypeDesc::UINT8, values.data());
    } else if (good) {
      good = out->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data());
    }
    if (!good || !out->close()) {
      throw Error(fmt::format("cannot encode an image as {}: {}", extension, out ? out->geterror() : OIIO::geterror()));
    }
    return {bytes.begin(), bytes.end()};
  }

  void draw_text(Image& image, int x, int y, const std::string& text, int size, Vec3 color, TextAlign align) const override {
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

  [[nodiscard]] int text_width(const std::string& text, int size) const override { return text_extent(text, size).width(); }
};

}  // namespace
}  // namespace raystudy

extern "C" const raystudy::ImageCodec* raystudy_image_codec() {
  static const raystudy::OpenImageIoCodec codec;
  return &codec;
}
