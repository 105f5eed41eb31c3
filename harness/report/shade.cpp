#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/geometry/sampling.h"
#include "harness/report/picture.h"

namespace raystudy {
namespace {

constexpr int max_bounces = 4;
constexpr float ambient_reach = 0.12F;  // of the scene's diagonal
constexpr Vec3 horizon{0.80F, 0.86F, 0.92F};
constexpr Vec3 zenith{0.30F, 0.48F, 0.80F};
constexpr Vec3 ambient_light{0.34F, 0.38F, 0.44F};
constexpr Vec3 unseen_light{0.035F, 0.033F, 0.030F};  // stands for light that bounced often
constexpr float eye_light = 0.09F;

Vec3 sky(Vec3 direction) {
  const float height = std::clamp(direction.y, 0.0F, 1.0F);
  return horizon * (1 - height) + zenith * height;
}

/// A ray on its way: which pixel its light goes to, and how much of it.
struct Path {
  Ray ray;
  Vec3 weight{1};
  std::uint32_t pixel = 0;
  std::uint64_t id = 0;
};

struct Surface {
  Vec3 point;
  Vec3 normal;  // unit length, towards where the ray came from
  bool entering = true;
};

class Shader {
 public:
  Shader(const Scene& scene, TraceSession& session, const RenderOptions& options, Image& image)
      : scene_(scene),
        session_(session),
        options_(options),
        image_(image),
        random_(options.seed, 1),
        glass_random_(options.seed, 2) {
    reach_ = ambient_reach * scene.diagonal();
    light_scale_ = scene.diagonal() * scene.diagonal() / 16;
  }

  /// Follows the paths to their ends and adds their light to the image.
  void shade(std::vector<Path> paths) {
    for (int bounce = 0; bounce <= max_bounces && !paths.empty(); ++bounce) paths = step(paths, bounce);
  }

 private:
  template <class F>
  static void each(std::size_t n, F&& f) {
    parallel_for_indices(n, f);
  }

  std::vector<Path> step(const std::vector<Path>& paths, int bounce) {
    const std::size_t n = paths.size();
    rays_.resize(n);
    hits_.resize(n);
    each(n, [&](std::size_t i) { rays_[i] = paths[i].ray; });
    session_.trace(rays_, hits_, Query::closest_hit);
    surfaces_.resize(n);
    each(n, [&](std::size_t i) {
      if (hits_[i].is_hit()) surfaces_[i] = surface(rays_[i], hits_[i]);
    });
    light_.assign(n, Vec3{0});
    const std::vector<Hit> first = hits_;
    for (const Light& light : scene_.lights) add_light(light, first);
    if (options_.ambient_rays > 0) add_ambient(paths, first, bounce);

    std::vector<Path> next;
    for (std::size_t i = 0; i < n; ++i) {
      float* out = &image_.pixels[std::size_t{3} * paths[i].pixel];
      const auto deposit = [&](Vec3 radiance) {
        const Vec3 share = paths[i].weight * radiance / static_cast<float>(options_.samples);
        for (int c = 0; c < 3; ++c) out[c] += share[c];
      };
      if (!first[i].is_hit()) {
        deposit(sky(normalized(paths[i].ray.direction)));
        continue;
      }
      const Material& material = scene_.material_of(first[i].triangle);
      const float towards_eye = std::fabs(dot(normalized(paths[i].ray.direction), surfaces_[i].normal));
      const Vec3 diffuse = material.color * (light_[i] + unseen_light + Vec3{eye_light * towards_eye});
      switch (material.kind) {
        case MaterialKind::emitter: deposit(material.emission); break;
        case MaterialKind::diffuse: deposit(diffuse + material.emission); break;
        case MaterialKind::reflective:
        case MaterialKind::refractive:
          if (bounce < max_bounces) {
            next.push_back(continued(paths[i], surfaces_[i], material, bounce));
          } else {
            deposit(diffuse);
          }
      }
    }
    return next;
  }

  [[nodiscard]] Surface surface(const Ray& ray, const Hit& hit) const {
    const Triangle& t = scene_.triangles[hit.triangle];
    const Vec3 a = scene_.vertices[t[0]];
    const Vec3 normal = cross(scene_.vertices[t[1]] - a, scene_.vertices[t[2]] - a);
    const float size = length(normal);
    Surface s;
    s.normal = size > 0 ? normal / size : Vec3{0, 1, 0};
    s.entering = dot(s.normal, ray.direction) < 0;
    if (!s.entering) s.normal = -s.normal;
    s.point = ray.origin + ray.direction * hit.t;
    return s;
  }

  /// Far enough from the surface that rounding cannot bring the start of a ray below it.
  [[nodiscard]] Vec3 offset(const Surface& s) const {
    const Vec3 p = s.point;
    const float scale = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z), 1e-3F * scene_.diagonal()});
    return s.normal * (scale * 2e-5F);
  }

  void add_light(const Light& light, const std::vector<Hit>& first) {
    const std::size_t n = first.size();
    each(n, [&](std::size_t i) {
      rays_[i] = {};
      rays_[i].tmax = -1;  // meets nothing; skipped below
      if (!first[i].is_hit()) return;
      const Vec3 origin = surfaces_[i].point + offset(surfaces_[i]);
      const Vec3 towards = light.point_at_infinity ? normalized(light.position) : light.position - origin;
      rays_[i] = {origin, 0, towards, light.point_at_infinity ? std::numeric_limits<float>::infinity() : 0.999F};
      if (dot(towards, surfaces_[i].normal) <= 0) rays_[i].tmax = -1;
    });
    trace_kept([](const Ray& ray) { return ray.tmax > 0; });
    each(n, [&](std::size_t i) {
      if (rays_[i].tmax <= 0 || hits_[i].is_hit()) return;
      const float distance = length(rays_[i].direction);
      const float cosine = dot(rays_[i].direction, surfaces_[i].normal) / distance;
      const float falloff = light.point_at_infinity ? 1 : light_scale_ / std::max(distance * distance, 1e-4F * light_scale_);
      light_[i] += light.intensity * (cosine * falloff);
    });
  }

  void add_ambient(const std::vector<Path>& paths, const std::vector<Hit>& first, int bounce) {
    const std::size_t n = first.size();
    const auto per_hit = static_cast<std::uint64_t>(options_.ambient_rays);
    for (std::uint64_t k = 0; k < per_hit; ++k) {
      each(n, [&](std::size_t i) {
        rays_[i].tmax = -1;
        if (!first[i].is_hit()) return;
        const std::uint64_t base = (paths[i].id * (max_bounces + 1) + static_cast<std::uint64_t>(bounce)) * 2 * per_hit;
        // Cosine-distributed; stratified in the angle around the normal.
        const float u = random_.uniform(base + 2 * k);
        const float turn = (static_cast<float>(k) + random_.uniform(base + 2 * k + 1)) / static_cast<float>(per_hit);
        rays_[i] = {surfaces_[i].point + offset(surfaces_[i]), 0, Frame(surfaces_[i].normal).to_world(cosine_direction(u, turn)),
                    reach_};
      });
      trace_kept([](const Ray& ray) { return ray.tmax > 0; });
      each(n, [&](std::size_t i) {
        if (rays_[i].tmax > 0 && !hits_[i].is_hit()) light_[i] += ambient_light / static_cast<float>(per_hit);
      });
    }
  }

  /// Traces those of `rays_` that `keep` says; the others get no hit.
  template <class F>
  void trace_kept(F&& keep) {
    kept_.clear();
    places_.clear();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      if (!keep(rays_[i])) continue;
      kept_.push_back(rays_[i]);
      places_.push_back(i);
    }
    kept_hits_.resize(kept_.size());
    session_.trace(kept_, kept_hits_, Query::any_hit);
    std::fill(hits_.begin(), hits_.end(), Hit{});
    for (std::size_t k = 0; k < places_.size(); ++k) hits_[places_[k]] = kept_hits_[k];
  }

  /// The mirrored or, in glass, by chance of Fresnel's share (Schlick 1994) the refracted ray.
  [[nodiscard]] Path continued(const Path& path, const Surface& s, const Material& material, int bounce) const {
    const Vec3 d = normalized(path.ray.direction);
    const float cosine = -dot(d, s.normal);
    Path next = path;
    next.weight = path.weight * material.color;
    Vec3 direction = d + s.normal * (2 * cosine);
    Vec3 shift = offset(s);
    if (material.kind == MaterialKind::refractive) {
      const float ratio = s.entering ? 1 / material.refraction_index : material.refraction_index;
      const float k = 1 - ratio * ratio * (1 - cosine * cosine);
      const float r0 = (1 - ratio) * (1 - ratio) / ((1 + ratio) * (1 + ratio));
      const float inner = ratio > 1 ? std::sqrt(std::max(0.0F, k)) : cosine;
      const float miss = 1 - inner;
      const float fresnel = r0 + (1 - r0) * miss * miss * miss * miss * miss;
      const auto draw = path.id * (max_bounces + 1) + static_cast<std::uint64_t>(bounce);
      if (k > 0 && glass_random_.uniform(draw) >= fresnel) {
        direction = d * ratio + s.normal * (ratio * cosine - std::sqrt(k));
        shift = -shift;
      }
    }
    next.ray = {s.point + shift, 0, direction, std::numeric_limits<float>::infinity()};
    return next;
  }

  const Scene& scene_;
  TraceSession& session_;
  const RenderOptions& options_;
  Image& image_;
  IndexedRandom random_;
  IndexedRandom glass_random_;
  float reach_ = 0;
  float light_scale_ = 1;
  std::vector<Ray> rays_;
  std::vector<Hit> hits_;
  std::vector<Surface> surfaces_;
  std::vector<Vec3> light_;
  std::vector<Ray> kept_;
  std::vector<Hit> kept_hits_;
  std::vector<std::size_t> places_;
};

}  // namespace

Image render_shaded(const Scene& scene, const Camera& camera, TraceSession& session, const RenderOptions& options) {
  Image image = filled_image(options.width, options.height, Vec3{0});
  image.kind = ImageKind::radiance;
  const Vec3 forward = normalized(camera.target - camera.eye);
  const Vec3 right = normalized(cross(forward, camera.up));
  const Vec3 up = cross(right, forward);
  const float half_height = std::tan(camera.vertical_fov * std::numbers::pi_v<float> / 360);
  const float half_width = half_height * static_cast<float>(options.width) / static_cast<float>(options.height);
  const int grid = static_cast<int>(std::lround(std::sqrt(options.samples)));
  const auto per_pixel = static_cast<std::uint64_t>(options.samples);
  const IndexedRandom jitter(options.seed, 0);
  Shader shader(scene, session, options, image);
  // Some rows at a time: batches long enough for every tracer, memory that does not grow with the picture.
  const int rows = std::max(1, static_cast<int>(150'000 / (static_cast<std::int64_t>(options.width) * options.samples)));
  for (int top = 0; top < options.height; top += rows) {
    const int bottom = std::min(options.height, top + rows);
    std::vector<Path> paths;
    for (int y = top; y < bottom; ++y) {
      for (int x = 0; x < options.width; ++x) {
        const auto pixel = static_cast<std::uint32_t>(y * options.width + x);
        for (int k = 0; k < options.samples; ++k) {
          Path path;
          path.pixel = pixel;
          path.id = pixel * per_pixel + static_cast<std::uint64_t>(k);
          const float jx = jitter.uniform(2 * path.id);
          const float jy = jitter.uniform(2 * path.id + 1);
          const int column = k % grid;
          const int row = k / grid;
          const float px = (static_cast<float>(x) + (static_cast<float>(column) + jx) / static_cast<float>(grid)) /
                           static_cast<float>(options.width);
          const float py = (static_cast<float>(y) + (static_cast<float>(row) + jy) / static_cast<float>(grid)) /
                           static_cast<float>(options.height);
          path.ray.origin = camera.eye;
          path.ray.direction = normalized(forward + right * ((2 * px - 1) * half_width) + up * ((1 - 2 * py) * half_height));
          paths.push_back(path);
        }
      }
    }
    shader.shade(std::move(paths));
    if (options.progress) options.progress(static_cast<double>(bottom) / options.height);
  }
  return image;
}

}  // namespace raystudy
