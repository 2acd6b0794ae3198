#include "bench/peers/embree_engine.h"

#include <algorithm>
#include <bit>

#include "core/base/error.h"
#include "core/shading/shade.h"
#include "recursive/render.h"

namespace raypool::peers {

namespace {

/// A register of paths side by side, over Embree's packets: what there is in place of the tracer of recursive/.
///
/// A lane whose path has ended takes the next path, of this line or of the next, so a packet is full until its thread
/// runs out of paths. Shading is the pool's: the kernels of core/, a register at a time.
template <Features features>
class alignas(64) PacketTracer final : public recursive::LineTracer {
    using Real = Packet;
    using Uint = Uint32<Real>;
    static constexpr int kRays = kLanes<Real>;
    static constexpr unsigned kAll = kAllBits<Mask<Real>>;

  public:
    PacketTracer(const CompiledScene<float>& scene, const RenderSettings& settings, Framebuffer& framebuffer,
                 const EmbreeScene& embree)
        : scene_(scene),
          embree_(embree),
          framebuffer_(framebuffer),
          seed_(random_seed(settings.seed, settings.sampler)),
          depth_(settings.depth),
          roulette_(settings.roulette),
          light_sampling_(needed_light_sampling(scene.features, settings)),
          converter_(framebuffer.fixed_point()) {
        std::fill_n(step_, kRays, 1U);
    }

    void trace(const LinePixels& line, std::int64_t first, std::int64_t end, Addition addition,
               ProgressBatch& progress) override {
        progress.add(line.count * (end - first));
        if (depth_ == 0) return;
        addition_ = addition;
        const std::int64_t y = line[0] / scene_.width;
        std::int64_t i = 0;
        std::int64_t sample = first;
        for (;;) {
            unsigned free = kAll & ~mask_bits(is_alive_);
            for (; free != 0 && i < line.count; free &= free - 1) {
                const int lane = std::countr_zero(free);
                pixel_[lane] = static_cast<std::uint32_t>(line[i]);
                x_[lane] = static_cast<float>(line[i] - y * scene_.width);
                y_[lane] = static_cast<float>(y);
                sample_[lane] = static_cast<std::uint32_t>(sample);
                step_[lane] = 0;
                if (++sample == end) ++i, sample = first;
            }
            start_paths();
            if (free != 0) return;  // the next line has paths for them
            advance();
        }
    }
    void finish() override {
        while (any(is_alive_)) advance();
    }
    void report(ThreadReport& work, SampleStatistics& statistics) const override {
        work.segments = segments_;
        work.shadow_rays = shadow_rays_;
        statistics = converter_.statistics();
    }

  private:
    template <class T>
    RAYPOOL_INLINE static T load(const typename T::value_type* lanes) {
        return T(lanes, stdx::vector_aligned);
    }

    /// Camera rays in the lanes whose path has made no step.
    RAYPOOL_INLINE void start_paths() {
        const Mask<Real> is_new = from_uint32<Real>(load<Uint>(step_)) == Real(0);
        if (none(is_new)) return;
        const Ray<Real> made = camera_ray<features, Real>(scene_.camera, load<Real>(x_), load<Real>(y_),
                                                          load<Uint>(pixel_), load<Uint>(sample_), seed_);
        ray_.origin = select<Real>(is_new, made.origin, ray_.origin);
        ray_.direction = select<Real>(is_new, made.direction, ray_.direction);
        ray_.time = select(is_new, made.time, ray_.time);
        throughput_ = select<Real>(is_new, vec3<Real>(Real(1), Real(1), Real(1)), throughput_);
        leaving_id_ = select(is_new, Int<Real>(kNoPrimitive), leaving_id_);
        density_ = select(is_new, Real(0), density_);
        is_alive_ = is_alive_ || is_new;
    }

    /// Takes all paths through one segment.
    RAYPOOL_INLINE void advance() {
        const unsigned active = mask_bits(is_alive_);
        segments_ += std::popcount(active);
        const Hit<Real> hit = closest_hits<features>(embree_, scene_, ray_, leaving_id_, is_alive_);
        const Mask<Real> is_hit = as_mask<Real>(hit.primitive_id >= Int<Real>(0));
        const unsigned hits = mask_bits(is_hit) & active;
        if (const unsigned misses = active & ~hits; misses != 0)
            contribute(
                escaping_radiance<features, Real>(scene_, ray_.direction, throughput_, light_sampling_, density_),
                misses);

        is_alive_ = is_alive_ && is_hit;
        const Uint step = load<Uint>(step_);
        const Uint next_step = step + Uint(1U);
        next_step.copy_to(step_, stdx::vector_aligned);
        if (hits == 0) return;  // and there may be nothing to hit

        const Int<Real> id = select(is_hit, hit.primitive_id, Int<Real>(0));
        LightPart<Real> lights;
        if constexpr (features.lights) {
            lights.sampling = light_sampling_;
            lights.arriving_density = density_;
            lights.depth = depth_;
        }
        const Scattered<Real> out =
            scatter<features, Real>(scene_, ray_, hit.t, id, throughput_, {load<Uint>(pixel_), load<Uint>(sample_)},
                                    step, seed_, 0, roulette_, features.lights ? &lights : nullptr);
        if constexpr (features.lights) {
            follow_shadow_rays(out, lights, mask_bits(lights.has_shadow_ray) & hits);
            density_ = lights.density;
        }
        if constexpr (features.emissive) {
            if (const unsigned ends = mask_bits(out.is_emitter) & hits; ends != 0) contribute(out.throughput, ends);
        }
        ray_.origin = out.start.origin;
        ray_.direction = out.direction;
        throughput_ = out.throughput;
        leaving_id_ = out.start.leaving_id;
        const Mask<Real> is_deepest = from_uint32<Real>(next_step) >= Real(static_cast<float>(depth_));
        is_alive_ = is_alive_ && out.is_alive && !is_deepest;
    }

    /// What the shadow rays of the lanes in `bits` bring.
    RAYPOOL_INLINE void follow_shadow_rays(const Scattered<Real>& out, const LightPart<Real>& lights, unsigned bits) {
        if (bits == 0) return;
        shadow_rays_ += std::popcount(bits);
        const LightSample<Real>& light = lights.light;
        const Mask<Real> is_hidden = are_occluded<features>(
            embree_, scene_, {out.start.origin, light.direction, ray_.time}, out.start.leaving_id,
            {light.t, light.primitive_id}, lights.has_shadow_ray && is_alive_);
        contribute(lights.radiance, bits & ~mask_bits(is_hidden));
    }

    /// Adds the radiance that paths bring, of the lanes in `bits`.
    RAYPOOL_INLINE void contribute(const Vec3<Real>& radiance, unsigned bits) {
        alignas(64) float channel[3][kRays];
        for (int k = 0; k < 3; ++k) radiance[k].copy_to(channel[k], stdx::vector_aligned);
        for (; bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const FixedRgb sample =
                converter_.template convert<float>(vec3<float>(channel[0][i], channel[1][i], channel[2][i]));
            if (addition_ == Addition::Plain) {
                framebuffer_.template add<Addition::Plain>(cell(i), sample);
            } else {
                framebuffer_.template add<Addition::Atomic>(cell(i), sample);
            }
        }
    }
    [[nodiscard]] std::int64_t cell(int lane) const {
        return cell_of(framebuffer_.has_halves(), pixel_[lane], sample_[lane]);
    }

    const CompiledScene<float>& scene_;
    const EmbreeScene& embree_;
    Framebuffer& framebuffer_;
    RandomSeed seed_;
    std::int32_t depth_;
    bool roulette_;
    LightSampling light_sampling_;
    SampleConverter converter_;
    std::int64_t segments_ = 0;
    std::int64_t shadow_rays_ = 0;
    Addition addition_ = Addition::Plain;

    // The paths, a lane each.
    Mask<Real> is_alive_ = Mask<Real>(false);
    Ray<Real> ray_{};
    Vec3<Real> throughput_{};
    Int<Real> leaving_id_{};
    Real density_{};  ///< of the ray's direction, where lights were sampled too; else 0
    alignas(64) std::uint32_t pixel_[kRays]{};
    alignas(64) std::uint32_t sample_[kRays]{};
    alignas(64) std::uint32_t step_[kRays];  ///< 0 only before a path's first segment
    alignas(64) float x_[kRays]{};
    alignas(64) float y_[kRays]{};
};

template <Features features, recursive::Rules rules>
using SingleTracer =
    recursive::CompiledLineTracer<recursive::Form::Iterative, features, float, EmbreeSearch, Splitting::Off, rules>;

using MakeTracer = decltype(recursive::TracerMaker<float>::make);

template <Features features, recursive::Rules rules>
MakeTracer single_tracers(const CompiledScene<float>& scene, EmbreeTriangles triangles) {
    const auto embree = std::make_shared<EmbreeScene>(scene, ShapeFunctions::make<features, float>(), triangles);
    return [embree](const CompiledScene<float>& of, const RenderSettings& settings, Framebuffer& framebuffer) {
        return std::make_unique<SingleTracer<features, rules>>(of, settings, framebuffer,
                                                               EmbreeSearch{{}, embree.get()});
    };
}

template <Features features>
MakeTracer packet_tracers(const CompiledScene<float>& scene, EmbreeTriangles triangles) {
    const auto embree = std::make_shared<EmbreeScene>(scene, ShapeFunctions::make<features, Packet>(), triangles);
    return [embree](const CompiledScene<float>& of, const RenderSettings& settings, Framebuffer& framebuffer) {
        return std::make_unique<PacketTracer<features>>(of, settings, framebuffer, *embree);
    };
}

}  // namespace

std::unique_ptr<RenderSession> EmbreeEngine::begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                   Framebuffer& framebuffer) const {
    if (settings.split_depth > 0) throw InputError(name() + ": follows one path at a time; --split-depth must be 0");
    if (!scene.instance_tree.blocks.empty()) throw InputError(name() + ": has no instances");
    if (settings.count_work) throw InputError(name() + ": Embree does not say which boxes it tests");
    if (settings.cost_image != nullptr) throw InputError(name() + ": has no cost of a pixel");
    const MakeTracer make = dispatch_features(needed_features(scene.features, settings), [&]<Features features>() {
        if (rays_ == EmbreeRays::Packet) return packet_tracers<features>(scene, triangles_);
        return recursive::are_plain(settings) ? single_tracers<features, recursive::Rules::Plain>(scene, triangles_)
                                              : single_tracers<features, recursive::Rules::Any>(scene, triangles_);
    });
    return std::make_unique<recursive::Session<float>>(scene, settings, framebuffer,
                                                       recursive::TracerMaker<float>{make, nullptr});
}

std::unique_ptr<RenderSession> EmbreeEngine::begin(const CompiledScene<double>&, const RenderSettings&,
                                                   Framebuffer&) const {
    throw InputError(name() + ": Embree traces in single precision");
}

std::vector<std::shared_ptr<const EmbreeEngine>> embree_engines(bool has_meshes) {
    std::vector<std::shared_ptr<const EmbreeEngine>> engines;
    for (const auto triangles : {EmbreeTriangles::Ours, EmbreeTriangles::Embrees}) {
        if (triangles == EmbreeTriangles::Embrees && !has_meshes) break;
        for (const auto rays : {EmbreeRays::Single, EmbreeRays::Packet})
            engines.push_back(std::make_shared<const EmbreeEngine>(rays, triangles));
    }
    return engines;
}

}  // namespace raypool::peers
