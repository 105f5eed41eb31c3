#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "harness/geometry/vec3.h"

namespace raystudy {

/// What an image's numbers are: linear radiance, linear colours between 0 (black) and 1 (white) to be shown as they are, or
/// measured figures.
enum class ImageKind : unsigned char { radiance, color, data };

/// Rows from the top, pixels from the left, channels interleaved.
struct Image {
  int width = 0;
  int height = 0;
  ImageKind kind = ImageKind::color;
  std::vector<std::string> channels{"R", "G", "B"};
  std::vector<float> pixels{};

  [[nodiscard]] float* at(int x, int y) { return &pixels[index(x, y)]; }
  [[nodiscard]] const float* at(int x, int y) const { return &pixels[index(x, y)]; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * channels.size();
  }
};

/// An image of one colour.
[[nodiscard]] Image filled_image(int width, int height, Vec3 color);

/// Radiance to colours: `exposure` times radiance through the filmic curve of Narkowicz 2016 ("ACES Filmic Tone Mapping Curve").
[[nodiscard]] Image tone_mapped(const Image& radiance, float exposure = 1);

/// Where drawn text stands against its point.
enum class TextAlign : unsigned char { left, center, right };
/// Draws `text` of `size` pixels with its middle line at y. Throws Error where no font is installed.
void draw_text(Image& image, int x, int y, const std::string& text, int size, Vec3 color, TextAlign align = TextAlign::left);
/// Width of `text` in pixels. Throws Error where no font is installed.
[[nodiscard]] int text_width(const std::string& text, int size);

/// The images in a row on white, `gap` pixels apart, each with its label above (none where `labels` is empty). Radiance is tone
/// mapped. Throws std::logic_error for images of different heights, of kind `data`, or as many labels as there are not images.
[[nodiscard]] Image side_by_side(std::span<const Image> images, std::span<const std::string> labels = {}, int gap = 8);

/// Throws Error where `file` ends neither in .png nor in .exr or cannot be created.
void require_writable_image(const std::filesystem::path& file);

/// Writes atomically, by the file's extension: PNG with 8 bits and the sRGB curve (radiance is tone mapped; `data` cannot be
/// shown: std::logic_error), or EXR with the numbers as they are in 32-bit float channels. Throws Error naming the file and the
/// system's reason.
void write_image(const std::filesystem::path& file, const Image& image);

}  // namespace raystudy
