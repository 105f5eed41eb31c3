#include "harness/method/registry.h"
#include "methods/embree/embree_accel.h"

namespace raystudy::embree {
namespace {

RTCBuildQuality quality_of(const std::string& name) {
  if (name == "low") return RTC_BUILD_QUALITY_LOW;
  return name == "high" ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
}

}  // namespace

class EmbreeBuilder final : public Builder {
 public:
  explicit EmbreeBuilder(const Params& params)
      : options_{.quality = quality_of(params.text("quality")),
                 .robust = params.boolean("robust"),
                 .compact = params.boolean("compact"),
                 .dynamic = params.boolean("dynamic")} {}
  static MethodInfo info() {
    return {.name = "embree",
            .summary = "Intel Embree's own BVH: the baseline every method stands beside",
            .citation = "Wald, Woop, Benthin, Johnson, Ernst 2014, Embree: A Kernel Framework for Efficient CPU Ray Tracing",
            .params = {choice_param("quality", {"medium", "low", "high"},
                                    "RTC_BUILD_QUALITY_*: low is Morton codes, medium binned SAH, high SAH with spatial splits"),
                       boolean_param("robust", false, "RTC_SCENE_FLAG_ROBUST: no hit is lost between triangles"),
                       boolean_param("compact", false, "RTC_SCENE_FLAG_COMPACT: less memory, slower to trace"),
                       boolean_param("dynamic", false, "RTC_SCENE_FLAG_DYNAMIC: faster to build, slower to trace")},
            .accel = std::string(EmbreeAccel::kind_name)};
  }
  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    return std::make_unique<EmbreeAccel>(scene, options_, context.threads);
  }

 private:
  BuildOptions options_;
};

const Registration<EmbreeBuilder> embree_builder;

}  // namespace raystudy::embree
