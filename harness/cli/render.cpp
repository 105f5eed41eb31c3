#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/cli/verb.h"
#include "harness/method/registry.h"
#include "harness/report/picture.h"
#include "harness/run/pipeline.h"
#include "harness/scene/animation.h"
#include "harness/scene/open.h"
#include "harness/scene/procedural.h"

namespace raystudy::cli {
namespace {

struct Options {
  std::string scene;
  std::int64_t triangles = 100'000;
  std::uint64_t seed = 1;
  std::string camera;
  std::optional<double> time;
  int frames = 0;  ///< 0: one picture
  int width = 960;
  int height = 600;
  int samples = 0;  ///< 0: 4 of a shaded picture, 1 of a heat map
  int ambient_rays = 8;
  float exposure = 1;
  bool heat_map = false;
  bool compare = false;
  std::string builder;
  std::vector<std::string> optimizers;
  std::string tracer;
  std::vector<std::string> workloads;
  float max_steps = 100;
  bool legend = true;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::string output;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("scene", o.scene, "A scene of the catalog, a procedural one, or a file (a name with a '/')")->required();
  app.add_option("-o,--output", o.output, "The picture: .png, or .exr with linear radiance or raw step counts")->required();
  app.add_option("--triangles", o.triangles, "Of a procedural scene")->capture_default_str();
  app.add_option("--seed", o.seed, "Of a procedural scene, of optimizers and of workloads")->capture_default_str();
  app.add_option("--camera", o.camera, "The scene's first where none is named");
  auto* time = app.add_option("--time", o.time, "Of an animated scene: from 0, its first key frame, to 1, its last");
  app.add_option("--frames", o.frames, "A contact sheet: so many pictures at equally spaced times")
      ->check(CLI::Range(2, 100))
      ->excludes(time);
  app.add_option("--width", o.width, "Pixels")->capture_default_str()->check(CLI::Range(16, 16384));
  app.add_option("--height", o.height, "Pixels")->capture_default_str()->check(CLI::Range(16, 16384));
  app.add_option("--samples", o.samples, "Primary rays a pixel; a square number")
      ->capture_default_str()
      ->check(CLI::Range(1, 4096));
  app.add_option("--ambient-rays", o.ambient_rays, "Of a shaded picture, a sample")
      ->capture_default_str()
      ->check(CLI::Range(0, 4096));
  app.add_option("--exposure", o.exposure, "Of a shaded PNG")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_flag("--heat-map", o.heat_map, "Traversal steps per ray of each pixel in place of the shaded picture");
  app.add_flag("--compare", o.compare,
               "In a row: the shaded picture, the steps of the builder's tree, and those after the optimizers");
  app.add_option("--builder", o.builder, "embree, or sweep-sah for a heat map, where none is named");
  app.add_option("--optimize", o.optimizers, "Optimizers in order");
  app.add_option("--tracer", o.tracer, "Where none is named, the first that can trace what the builder makes, and needs no device");
  app.add_option("--workload", o.workloads, "Whose rays a heat map counts: primary and ambient-occlusion where none is named");
  app.add_option("--max-steps", o.max_steps, "The end of a heat map's colour scale")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_flag("!--no-legend", o.legend, "A heat map without its colour scale");
  app.add_option("--threads", o.threads, "Threads")->capture_default_str()->check(CLI::Range(1, 1024));
}

/// The named tracer, or the first by name of those that trace `kind` and need no device.
std::unique_ptr<Tracer> choose_tracer(const Options& o, const std::string& kind) {
  const Registry& registry = Registry::instance();
  std::vector<std::string> able;
  std::string first;
  for (const std::string& name : registry.names(Role::tracer)) {
    const MethodInfo& info = registry.get(Role::tracer, name).info;
    if (info.accel != kind) continue;
    able.push_back(name);
    if (first.empty() && !info.on_device) first = name;
  }
  const auto refuse = [&](const std::string& message) {
    throw Error(Diagnostic{{}, message, able.empty() ? "another builder" : fmt::format("one of {}", fmt::join(able, ", ")), {}});
  };
  if (!o.tracer.empty()) {
    const Registry::Entry& entry = registry.get(Role::tracer, o.tracer);
    if (entry.info.accel != kind) {
      refuse(fmt::format("tracer '{}' cannot trace what builder '{}' makes ('{}')", o.tracer, o.builder, kind));
    }
  } else if (first.empty()) {
    refuse(fmt::format("no tracer can trace what builder '{}' makes ('{}')", o.builder, kind));
  }
  return registry.create<Tracer>({o.tracer.empty() ? first : o.tracer, nullptr});
}

std::vector<MethodRef> choose_workloads(const Options& o) {
  const Registry& registry = Registry::instance();
  std::vector<std::string> of_pixels;
  const auto has_pixels = [&](const std::string& name) {
    const auto& params = registry.get(Role::workload, name).info.params;
    return std::any_of(params.begin(), params.end(), [](const ParamSpec& p) { return p.name == "camera"; });
  };
  for (const std::string& name : registry.names(Role::workload)) {
    if (has_pixels(name)) of_pixels.push_back(name);
  }
  std::vector<MethodRef> refs;
  for (const std::string& name : o.workloads) {
    if (!has_pixels(name)) {
      throw Error(Diagnostic{{},
                             fmt::format("the rays of workload '{}' do not belong to pixels", name),
                             fmt::format("one of {}", fmt::join(of_pixels, ", ")),
                             {}});
    }
    refs.push_back(registry.ref(Role::workload, name,
                                {{"camera", o.camera},
                                 {"width", std::int64_t{o.width}},
                                 {"height", std::int64_t{o.height}},
                                 {"samples", std::int64_t{o.samples}}}));
  }
  return refs;
}

/// What the pictures of one run share.
class Studio {
 public:
  explicit Studio(const Options& o)
      : o_(o),
        tracer_(choose_tracer(o, Registry::instance().get(Role::builder, o.builder).info.accel)),
        workloads_(o.heat_map ? choose_workloads(o) : std::vector<MethodRef>{}) {
    spec_.label = o.builder;
    spec_.builder = Registry::instance().ref(Role::builder, o.builder);
    for (const std::string& name : o.optimizers) spec_.optimizers.push_back(Registry::instance().ref(Role::optimizer, name));
    progress_.update(0, "opening the scene");
    animation_ = open_scene(o.scene, o.triangles, o.seed);
    if ((o.time || o.frames > 0) && animation_.frames.empty()) {
      throw Error(Diagnostic{
          {}, fmt::format("scene '{}' does not move", animation_.name), "a scene with key frames for --time and --frames", {}});
    }
    scene_ = animation_;
    if (o.time) set_time(*o.time);
    (void)camera();
  }

  /// What is built and shown from now on is the scene at that time.
  void set_time(double time) { scene_ = scene_at(animation_, time); }

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const Camera& camera() const { return scene_.camera(o_.camera); }

  /// The tree of the builder and, where `optimized`, of the optimizers, ready to be traced.
  void build(bool optimized) {
    PipelineSpec spec = spec_;
    if (!optimized) spec.optimizers.clear();
    BuildContext context;
    context.threads = o_.threads;
    context.seed = o_.seed;
    StageTimes times;
    session_.reset();
    accel_ = Pipeline(spec).run(scene_, context, times, [this](std::string_view stage) { progress_.update(0, stage); });
    session_ = tracer_->prepare(*accel_, scene_, o_.threads, false);
    if (o_.heat_map && !session_->counts()) throw Error(cannot_count_text);
  }

  Image shaded() {
    return render_shaded(scene_, camera(), *session_,
                         {.width = o_.width,
                          .height = o_.height,
                          .samples = o_.samples,
                          .ambient_rays = o_.ambient_rays,
                          .seed = o_.seed,
                          .progress = [this](double share) { progress_.update(share, "tracing"); }});
  }

  StepMap steps() {
    const WorkloadContext context{.seed = o_.seed, .closest_hits = [this](std::span<const Ray> rays, std::span<Hit> hits) {
                                    session_->trace(rays, hits, Query::closest_hit);
                                  }};
    std::vector<RayBatch> batches;
    for (const MethodRef& ref : workloads_) {
      progress_.update(0, fmt::format("making the rays of {}", ref.name));
      batches.push_back(Registry::instance().create<Workload>(ref)->generate(scene_, context));
    }
    progress_.update(0.5, "counting steps");
    return count_steps(*session_, batches);
  }

 private:
  const Options& o_;
  std::unique_ptr<Tracer> tracer_;
  std::vector<MethodRef> workloads_;
  PipelineSpec spec_;
  Progress progress_{"render", 1};
  Scene animation_;
  Scene scene_;  ///< at the time that is shown
  std::unique_ptr<Accel> accel_;
  std::unique_ptr<TraceSession> session_;
};

/// Adds an image of the same width at the lower end.
void put_below(Image& image, const Image& next) {
  image.pixels.insert(image.pixels.end(), next.pixels.begin(), next.pixels.end());
  image.height += next.height;
}

/// The shaded picture, and the heat maps before and after optimization, over one colour scale.
Image comparison(Studio& studio, const Options& o) {
  studio.build(false);
  std::vector<Image> images{tone_mapped(studio.shaded(), o.exposure)};
  std::vector<std::string> labels{fmt::format("{}, {} triangles", studio.scene().name, studio.scene().triangles.size())};
  const HeatMapOptions scale{.max_steps = o.max_steps, .legend = false};
  const StepMap before = studio.steps();
  studio.build(true);
  const StepMap after = studio.steps();
  images.push_back(heat_map(before, scale));
  labels.push_back(fmt::format("{}: {:.1f} steps", o.builder, before.mean));
  images.push_back(heat_map(after, scale));
  labels.push_back(fmt::format("{} + {}: {:.1f} steps", o.builder, fmt::join(o.optimizers, " + "), after.mean));
  Image row = side_by_side(images, labels);
  if (o.legend) put_below(row, heat_legend(row.width, scale));
  return row;
}

/// Pictures at equally spaced times with a tree of their own each, in rows of about the same length, four at most.
Image contact_sheet(Studio& studio, const Options& o) {
  const std::size_t rows = (static_cast<std::size_t>(o.frames) + 3) / 4;
  const std::size_t columns = (static_cast<std::size_t>(o.frames) + rows - 1) / rows;
  const HeatMapOptions scale{.max_steps = o.max_steps, .legend = false};
  std::vector<Image> images;
  std::vector<std::string> labels;
  for (const double time : uniform_times(static_cast<std::size_t>(o.frames))) {
    studio.set_time(time);
    studio.build(true);
    images.push_back(o.heat_map ? heat_map(studio.steps(), scale) : tone_mapped(studio.shaded(), o.exposure));
    labels.push_back(fmt::format("t = {:.3f}", time));
  }
  images.resize(rows * columns, filled_image(o.width, o.height, Vec3{1}));
  labels.resize(images.size());
  Image sheet;
  for (std::size_t row = 0; row < rows; ++row) {
    const Image strip =
        side_by_side(std::span(images).subspan(row * columns, columns), std::span(labels).subspan(row * columns, columns));
    sheet.width = strip.width;
    put_below(sheet, strip);
  }
  if (o.heat_map && o.legend) put_below(sheet, heat_legend(sheet.width, scale));
  return sheet;
}

Image picture(Studio& studio, const Options& o) {
  const bool raw = o.output.ends_with(".exr");
  if (o.compare) return comparison(studio, o);
  if (o.frames > 0) return contact_sheet(studio, o);
  studio.build(true);
  if (!o.heat_map) {
    Image image = studio.shaded();
    return raw ? image : tone_mapped(image, o.exposure);
  }
  const StepMap map = studio.steps();
  fmt::print("{:.2f} traversal steps per ray\n", map.mean);
  return raw ? step_image(map) : heat_map(map, {.max_steps = o.max_steps, .legend = o.legend});
}

int render(Options o) {
  require_writable_image(o.output);
  if (o.compare && o.optimizers.empty()) {
    throw Error(Diagnostic{{}, "--compare has nothing to compare", "an optimizer, by --optimize", {}});
  }
  if (o.frames > 0 && (o.compare || o.output.ends_with(".exr"))) {
    throw Error(Diagnostic{{}, fmt::format("--frames with {}", o.compare ? "--compare" : "an .exr file"), "either alone", {}});
  }
  o.heat_map = o.heat_map || o.compare;
  if (o.samples == 0) o.samples = o.heat_map && !o.compare ? 1 : 4;
  const auto side = static_cast<int>(std::lround(std::sqrt(o.samples)));
  if (side * side != o.samples) {
    throw Error(
        Diagnostic{{}, fmt::format("--samples is {}", o.samples), fmt::format("a square number such as {}", side * side), {}});
  }
  if (o.builder.empty()) o.builder = o.heat_map ? "sweep-sah" : "embree";
  if (o.workloads.empty()) o.workloads = {"primary", "ambient-occlusion"};
  Studio studio(o);
  write_image(o.output, picture(studio, o));
  fmt::print("{}: {} of {} triangles, camera '{}'\n", o.output, studio.scene().name, studio.scene().triangles.size(),
             studio.camera().name);
  return exit_ok;
}

const Verb verb{"render", "A picture of a scene: shaded, or a heat map of traversal steps", [](CLI::App& app) {
                  auto options = std::make_shared<Options>();
                  declare(app, *options);
                  return [options] { return render(*options); };
                }};

}  // namespace
}  // namespace raystudy::cli
