#include "bench/peers/embree_engine.h"

#include "bench/peers/embree_scene.h"
#include "bench/peers/packet_tracer.h"
#include "core/base/error.h"
#include "recursive/render.h"

namespace raypool::peers {

namespace {

template <Features features, recursive::Rules rules>
using SingleTracer =
    recursive::CompiledLineTracer<recursive::Form::Iterative, features, float, EmbreeSearch, Splitting::Off, rules>;

using MakeTracer = decltype(recursive::TracerMaker<float>::make);

template <Features features, recursive::Rules rules>
MakeTracer single_tracers(const CompiledScene<float>& scene) {
    const auto embree = std::make_shared<EmbreeScene>(scene, ShapeFunctions::make<features, float>());
    return [embree](const CompiledScene<float>& of, const RenderSettings& settings, Framebuffer& framebuffer) {
        return std::make_unique<SingleTracer<features, rules>>(of, settings, framebuffer,
                                                               EmbreeSearch{{}, embree.get()});
    };
}

template <Features features>
MakeTracer packet_tracers(const CompiledScene<float>& scene) {
    const auto embree = std::make_shared<EmbreeScene>(scene, ShapeFunctions::make<features, Packet>());
    return [embree](const CompiledScene<float>& of, const RenderSettings& settings, Framebuffer& framebuffer) {
        return std::make_unique<PacketTracer<features>>(of, settings, framebuffer, *embree);
    };
}

}  // namespace

std::unique_ptr<RenderSession> EmbreeEngine::begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                   Framebuffer& framebuffer) const {
    if (settings.split_depth > 0) throw InputError(name() + ": follows one path at a time; --split-depth must be 0");
    if (settings.light_sampling != LightSampling::None)
        throw InputError(name() + ": traces no shadow rays; --light-sampling must be none");
    if (settings.count_work) throw InputError(name() + ": Embree does not say which boxes it tests");
    if (settings.cost_image != nullptr) throw InputError(name() + ": has no cost of a pixel");
    const MakeTracer make = dispatch_features(needed_features(scene.features, settings), [&]<Features features>() {
        if (rays_ == EmbreeRays::Packet) return packet_tracers<features>(scene);
        return recursive::are_plain(settings) ? single_tracers<features, recursive::Rules::Plain>(scene)
                                              : single_tracers<features, recursive::Rules::Any>(scene);
    });
    return std::make_unique<recursive::Session<float>>(scene, settings, framebuffer,
                                                       recursive::TracerMaker<float>{make, nullptr});
}

std::unique_ptr<RenderSession> EmbreeEngine::begin(const CompiledScene<double>&, const RenderSettings&,
                                                   Framebuffer&) const {
    throw InputError(name() + ": Embree traces in single precision");
}

}  // namespace raypool::peers
