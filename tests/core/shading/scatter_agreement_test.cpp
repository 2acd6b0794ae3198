/// What happens at the end of a segment, on the hits of real paths through scenes with every kind of surface: the same
/// bits one path at a time or a register of paths at a time.
#include <gtest/gtest.h>

#include "core/geometry/traverse.h"
#include "core/scene/scene_reader.h"
#include "core/shading/camera.h"
#include "core/shading/shade.h"
#include "tests/core/math/lane_agreement.h"

namespace raypool::test {
namespace {

/// Follows paths from random pixels and writes every hit into a row.
template <class Scalar>
class PathHits {
  public:
    explicit PathHits(const CompiledScene<Scalar>& scene) : scene_(scene) {}

    void fill(RandomInputs& random, Row<Scalar>& row) {
        Hit<Scalar> hit = trace();
        while (hit.primitive_id == kNoPrimitive) {
            start(random);
            hit = trace();
        }
        row.vec(ray_.origin), row.vec(ray_.direction), row.real(ray_.time), row.real(hit.t), row.vec(throughput_);
        row.word(static_cast<std::uint32_t>(hit.primitive_id));
        row.word(key_.pixel), row.word(key_.sample);
        const auto branch = static_cast<std::uint32_t>(random.one_in(4) ? random.below(20) : 0);
        row.word(bounce_ | branch << path_step::kBranchShift);

        const Scattered<Scalar> out = scatter<kEverything, Scalar>(scene_, ray_, hit.t, hit.primitive_id, throughput_,
                                                                   key_, bounce_, random_seed(0));
        if (!out.is_alive || bounce_ == 50) return start(random);
        ray_.origin = out.start.origin;
        ray_.direction = out.direction;
        throughput_ = out.throughput;
        leaving_id_ = static_cast<std::int32_t>(hit.primitive_id);
        ++bounce_;
    }

  private:
    void start(RandomInputs& random) {
        const auto x = static_cast<std::uint32_t>(random.below(static_cast<int>(scene_.width)));
        const auto y = static_cast<std::uint32_t>(random.below(static_cast<int>(scene_.height)));
        key_ = {y * static_cast<std::uint32_t>(scene_.width) + x, static_cast<std::uint32_t>(random.below(1000))};
        ray_ = camera_ray<kEverything, Scalar>(scene_.camera, Scalar(x), Scalar(y), key_.pixel, key_.sample,
                                               random_seed(0));
        throughput_ = vec3<Scalar>(1, 1, 1);
        leaving_id_ = kNoPrimitive;
        bounce_ = 0;
    }
    Hit<Scalar> trace() {
        NoTestCount work;
        return closest_hit<kEverything>(scene_, ray_, leaving_id_, work);
    }

    const CompiledScene<Scalar>& scene_;
    Ray<Scalar> ray_{vec3<Scalar>(0, 0, 0), vec3<Scalar>(0, 0, 1), 0};
    Vec3<Scalar> throughput_ = vec3<Scalar>(1, 1, 1);
    PathKey<Scalar> key_{0, 0};
    std::int32_t leaving_id_ = kNoPrimitive;
    std::uint32_t bounce_ = 0;
};

template <Features features, Splitting splitting, class Scalar, class Real>
void run_scatter(const CompiledScene<Scalar>& scene, const RandomSeed& seed, bool roulette, Arguments<Real> in,
                 Results<Real>& out) {
    Ray<Real> ray;
    ray.origin = in.vec();
    ray.direction = in.vec();
    ray.time = in.real();
    const Real t = in.real();
    const Vec3<Real> throughput = in.vec();
    const Int<Real> id = in.index();
    const Uint32<Real> pixel = in.word();
    const Uint32<Real> sample = in.word();
    const Uint32<Real> step = in.word();
    constexpr int kSplitDepth = splitting == Splitting::On ? 3 : 0;
    const Scattered<Real> after = scatter<features, Real, splitting>(scene, ray, t, id, throughput, {pixel, sample},
                                                                     step, seed, kSplitDepth, roulette);
    out(after.start.origin), out(after.throughput);
    out(select<Real>(after.is_emitter, throughput, after.direction));  // of an ended path it means nothing
    out.mask(after.is_alive), out.mask(after.is_emitter);
    if constexpr (splitting == Splitting::On) {
        out.mask(after.is_split), out.mask(after.is_reflected_alive);
        out(select<Real>(after.is_split, after.reflected_direction, throughput));
        out(select<Real>(after.is_split, after.reflected_throughput, throughput));
    }
}

/// With the features that the scene needs, and with all of them and glass that splits paths.
template <class Scalar, class... Reals>
void expect_scatter_agrees(const std::string& name) {
    constexpr int kScenes = 6;
    const CompiledScene<Scalar> scene = compile<Scalar>(
        name == "textures" ? read_scene(RAYPOOL_SOURCE_DIR "/scenes/textures/textures.json") : builtin_scene(name));
    PathHits<Scalar> hits(scene);
    dispatch_features(scene.features, [&]<Features features>() {
        expect_lanes_agree_for<Scalar, Reals...>(
            kInputs / kScenes, [&](RandomInputs& random, Row<Scalar>& row) { hits.fill(random, row); },
            [&]<class Real>(Arguments<Real>& in, Results<Real>& out) {
                run_scatter<features, Splitting::Off>(scene, random_seed(0), false, in, out);
                run_scatter<kEverything, Splitting::On>(scene, random_seed(1, Sampler::Sobol), true, in, out);
            });
    });
}

class ScatterAgreement : public testing::TestWithParam<const char*> {};

TEST_P(ScatterAgreement, HoldsInFloat) {
    expect_scatter_agrees<float, stdx::native_simd<float>, Wide<float, kTreeWidth<float>>>(GetParam());
}
TEST_P(ScatterAgreement, HoldsInDouble) {
    expect_scatter_agrees<double, stdx::native_simd<double>>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Scenes, ScatterAgreement,
                         testing::Values("paper", "textures", "glass_stack", "mirror_corridor", "cornell", "half_sky"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace raypool::test
