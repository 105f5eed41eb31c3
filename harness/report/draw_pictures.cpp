#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "harness/method/registry.h"
#include "harness/report/clusters.h"
#include "harness/report/figure.h"
#include "harness/report/picture.h"
#include "harness/run/pipeline.h"
#include "harness/scene/animation.h"
#include "harness/scene/open.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

template <class T>
const T& labelled(const std::vector<T>& things, const std::string& label) {
  return *std::find_if(things.begin(), things.end(), [&](const T& thing) { return thing.label == label; });
}

/// A label as part of a file's name.
std::string file_part(std::string label) {
  for (char& c : label) {
    if (c == '/' || c == ' ') c = '-';
  }
  return label;
}

/// One scene of a figure, with what its pictures have in common.
class SceneDrawer {
 public:
  SceneDrawer(const FigureSpec& figure, const Plan& plan, const SceneSpec& spec, fs::path folder, FigureOutcome& outcome)
      : figure_(figure),
        plan_(plan),
        spec_(spec),
        folder_(std::move(folder)),
        outcome_(outcome),
        scene_(open_scene(spec.name, spec.triangles, spec.seed)) {}

  void render() { write(shaded(), "", ".png"); }

  void heat_maps() {
    HeatMapOptions options;
    if (const auto highest = figure_.options.find("highest"); highest != figure_.options.end()) {
      options.max_steps = std::strtof(highest->second.c_str(), nullptr);
    }
    if (const auto lowest = figure_.options.find("lowest"); lowest != figure_.options.end()) {
      options.min_steps = std::strtof(lowest->second.c_str(), nullptr);
    }
    std::vector<Image> images{shaded()};
    std::vector<std::string> labels{"rendered"};
    for (const std::string& method : figure_.methods) {
      const StepMap map = steps(method);
      write(step_image(map), method, ".exr");
      const Image image = heat_map(map, options);
      write(image, method, ".png");
      images.push_back(image);
      labels.push_back(fmt::format("{}: {:.1f} steps per ray", method, map.mean));
      outcome_.remarks.push_back(fmt::format("{}, {}: {:.2f} traversal steps per ray", spec_.label, method, map.mean));
    }
    // White below the rendered image, where the others have their legend.
    Image& first = images.front();
    first.height = images.back().height;
    first.pixels.resize(images.back().pixels.size(), 1.0F);
    write(side_by_side(images, labels), "", ".png");
  }

  void film_strips() {
    const auto frames = static_cast<std::size_t>(std::stoul(figure_.options.at("frames")));
    const auto most = static_cast<std::uint32_t>(std::stoul(figure_.options.at("triangles")));
    RenderOptions options;
    options.width = std::stoi(figure_.options.at("width"));
    options.height = std::stoi(figure_.options.at("height"));
    const std::vector<double> times = uniform_times(frames);
    for (const std::string& method : figure_.methods) {
      const PipelineSpec& spec = labelled(plan_.pipelines, method);
      const Pipeline pipeline(spec);
      StageTimes ignored;
      const auto session = prepare_updates(pipeline, spec, scene_, times, context(), ignored);
      std::vector<Image> images;
      std::vector<std::string> labels;
      for (std::size_t f = 0; f < frames; ++f) {
        const Scene frame = scene_at(scene_, times[f]);
        const auto* bvh = dynamic_cast<const Bvh2*>(session->update(frame, f).accel);
        if (bvh == nullptr) throw Error(fmt::format("a film strip shows binary trees, which '{}' does not make", method));
        images.push_back(shaded(colored_by_cluster(frame, clusters_of(*bvh, most)), figure_.options.at("camera"), options));
        labels.push_back(fmt::format("time {:.2f}", times[f]));
      }
      write(side_by_side(images, labels), method, ".png");
    }
  }

 private:
  [[nodiscard]] BuildContext context() const {
    BuildContext context;
    context.threads = plan_.threads;
    context.seed = plan_.seed;
    context.cost = make_cost_model(plan_.cost, scene_, plan_.threads, plan_.seed);
    return context;
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const PipelineSpec& spec) const {
    StageTimes times;
    return Pipeline(spec).run(scene_, context(), times);
  }

  /// The view of the first workload, at its size.
  [[nodiscard]] Image shaded() const {
    const MethodRef& workload = labelled(plan_.workloads, figure_.workloads.front()).workload;
    RenderOptions options;
    options.width = static_cast<int>(workload.params->integer("width"));
    options.height = static_cast<int>(workload.params->integer("height"));
    return shaded(scene_, workload.params->text("camera"), options);
  }

  /// By way of Embree, whatever the figure is about.
  [[nodiscard]] Image shaded(const Scene& scene, const std::string& camera, RenderOptions options) const {
    const Registry& registry = Registry::instance();
    BuildContext context;
    context.threads = plan_.threads;
    const auto accel = registry.create<Builder>(registry.ref(Role::builder, "embree"))->build(scene, context);
    const auto tracer = registry.create<Tracer>(registry.ref(Role::tracer, "embree"));
    const auto session = tracer->prepare(*accel, scene, plan_.threads, false);
    options.seed = plan_.seed;
    return tone_mapped(render_shaded(scene, scene.camera(camera), *session, options));
  }

  StepMap steps(const std::string& method) {
    const auto accel = build(labelled(plan_.pipelines, method));
    const auto tracer = Registry::instance().create<Tracer>(labelled(plan_.tracers, figure_.tracer).tracer);
    const auto session = tracer->prepare(*accel, scene_, plan_.threads, false);
    if (batches_.empty()) {
      const WorkloadContext context{.seed = plan_.seed,
                                    .closest_hits = [&session](std::span<const Ray> rays, std::span<Hit> hits) {
                                      session->trace(rays, hits, Query::closest_hit);
                                    }};
      for (const std::string& label : figure_.workloads) {
        const auto workload = Registry::instance().create<Workload>(labelled(plan_.workloads, label).workload);
        batches_.push_back(workload->generate(scene_, context));
      }
    }
    return count_steps(*session, batches_);
  }

  /// NAME[-SCENE][-METHOD]: the scene where the figure has several.
  void write(const Image& image, const std::string& method, const std::string& extension) {
    std::string name = figure_.name;
    if (figure_.scenes.size() > 1) name += '-' + file_part(spec_.label);
    if (!method.empty()) name += '-' + file_part(method);
    const fs::path file = folder_ / (name + extension);
    write_image(file, image);
    outcome_.files.push_back(file);
  }

  const FigureSpec& figure_;
  const Plan& plan_;
  const SceneSpec& spec_;
  fs::path folder_;
  FigureOutcome& outcome_;
  Scene scene_;
  std::vector<RayBatch> batches_;  ///< the same rays for every method
};

}  // namespace

void draw_pictures(const FigureSpec& figure, const Plan& plan, const fs::path& folder, FigureOutcome& outcome) {
  for (const std::string& label : figure.scenes) {
    try {
      SceneDrawer drawer(figure, plan, labelled(plan.scenes, label), folder, outcome);
      if (figure.kind == "render") {
        drawer.render();
      } else if (figure.kind == "film-strip") {
        drawer.film_strips();
      } else {
        drawer.heat_maps();
      }
    } catch (const SceneNotInstalled& missing) {
      outcome.failed = true;
      outcome.gaps.emplace_back(missing.what());
    } catch (const Error& error) {
      outcome.failed = true;
      outcome.gaps.push_back(fmt::format("{}: {}", label, error.what()));
    }
  }
}

}  // namespace raystudy
