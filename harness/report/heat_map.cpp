#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "harness/base/error.h"
#include "harness/report/picture.h"

namespace raystudy {

StepMap count_steps(TraceSession& session, std::span<const RayBatch> batches) {
  if (batches.empty() || batches.front().width == 0) throw std::logic_error("count_steps: rays that belong to pixels are needed");
  if (!session.counts()) throw Error(cannot_count_text);
  StepMap map{.width = static_cast<int>(batches.front().width), .height = static_cast<int>(batches.front().height)};
  const std::size_t pixels = std::size_t{batches.front().width} * batches.front().height;
  std::vector<double> sums(pixels);
  std::vector<std::uint32_t> rays(pixels);
  double total = 0;
  std::size_t ray_count = 0;
  for (const RayBatch& batch : batches) {
    if (batch.width != batches.front().width || batch.height != batches.front().height) {
      throw std::logic_error("count_steps: batches of different image sizes");
    }
    std::vector<std::uint32_t> steps(batch.rays.size());
    session.count(batch.rays, batch.query, steps);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const std::size_t pixel = batch.ray_pixels.empty() ? i : batch.ray_pixels[i];
      sums.at(pixel) += steps[i];
      ++rays[pixel];
      total += steps[i];
    }
    ray_count += steps.size();
  }
  map.steps.resize(pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    if (rays[p] > 0) map.steps[p] = static_cast<float>(sums[p] / rays[p]);
  }
  map.mean = ray_count > 0 ? total / static_cast<double>(ray_count) : 0;
  return map;
}

Image step_image(const StepMap& map) {
  return {.width = map.width, .height = map.height, .kind = ImageKind::data, .channels = {"steps"}, .pixels = map.steps};
}

Vec3 heat_color(float t) {
  // Linear RGB. The stops lie so that the scale's brightness rises to yellow in the middle third and falls again to red.
  static constexpr std::array<Vec3, 5> stops{
      {{0.010F, 0.022F, 0.42F}, {0.01F, 0.42F, 0.72F}, {0.06F, 0.52F, 0.10F}, {0.95F, 0.80F, 0.03F}, {0.72F, 0.012F, 0.008F}}};
  const float x = std::clamp(t, 0.0F, 1.0F) * (stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(x), stops.size() - 2);
  const float f = x - static_cast<float>(i);
  return stops[i] * (1 - f) + stops[i + 1] * f;
}

Image heat_legend(int width, const HeatMapOptions& options) {
  const int text = std::clamp(width / 60, 11, 20);
  Image legend = filled_image(width, 4 * text + text / 2, Vec3{1});
  const int left = 2 * text;
  const int right = width - 3 * text;
  const int top = 2 * text - text / 3;
  const int bottom = top + text;
  draw_text(legend, width / 2, text - text / 4, options.quantity, text, Vec3{0}, TextAlign::center);
  for (int x = left; x <= right; ++x) {
    const Vec3 color = heat_color(static_cast<float>(x - left) / static_cast<float>(right - left));
    for (int y = top; y < bottom; ++y) {
      for (int c = 0; c < 3; ++c) legend.at(x, y)[c] = color[c];
    }
  }
  for (int tick = 0; tick <= 4; ++tick) {
    const int x = left + (right - left) * tick / 4;
    for (int y = bottom; y < bottom + text / 3; ++y) std::fill_n(legend.at(x, y), 3, 0.0F);
    const float value = options.min_steps + (options.max_steps - options.min_steps) * static_cast<float>(tick) / 4;
    // OpenImageIO 2.4 draws a wrong sign for "≥".
    const char* beyond = tick == 4 ? "+" : "";
    draw_text(legend, x, bottom + text, fmt::format("{:.4g}{}", value, beyond), text, Vec3{0}, TextAlign::center);
  }
  return legend;
}

Image heat_map(const StepMap& map, const HeatMapOptions& options) {
  if (!(options.max_steps > options.min_steps)) throw std::logic_error("heat_map: the scale's end must be above its start");
  Image picture = filled_image(map.width, map.height, Vec3{0});
  for (std::size_t p = 0; p < map.steps.size(); ++p) {
    const Vec3 color = heat_color((map.steps[p] - options.min_steps) / (options.max_steps - options.min_steps));
    for (int c = 0; c < 3; ++c) picture.pixels[3 * p + static_cast<std::size_t>(c)] = color[c];
  }
  if (!options.legend) return picture;
  const Image legend = heat_legend(map.width, options);
  picture.pixels.insert(picture.pixels.end(), legend.pixels.begin(), legend.pixels.end());
  picture.height += legend.height;
  return picture;
}

}  // namespace raystudy
