#include "bench/accuracy/changes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace raypool::accuracy {

namespace {

constexpr int kDepths[] = {3, 5, 8, 12, 20, 50, 200};

}  // namespace

Configuration trusted_for(const CompiledScene<double>& scene) {
    constexpr double kNothing = 1e-12;
    Configuration trusted = kTrusted;
    const double deepest = std::ceil(std::log(kNothing) / std::log(std::min(scene.max_albedo, 1 - 1e-9)));
    trusted.depth = static_cast<std::int32_t>(std::clamp<double>(deepest, kDepths[0], kDeep));
    return trusted;
}

std::vector<Change> changes(bool has_glass, const Configuration& trusted) {
    std::vector<Change> all{
        {"float instead of double", Group::Precision, [](Configuration& c) { c.precision = Precision::Float; }},
        {"recursion instead of the pool", Group::Engine, [](Configuration& c) { c.engine = EngineKind::Recursive; }}};
    for (const int depth : kDepths)
        if (depth < trusted.depth)
            all.push_back({fmt::format("depth {} instead of {}", depth, trusted.depth), Group::Depth,
                           [=](Configuration& c) { c.depth = depth; }});
    all.push_back({"Sobol points instead of independent ones", Group::Sampler,
                   [](Configuration& c) { c.sampler = Sampler::Sobol; }});
    all.push_back({"roulette", Group::Roulette, [](Configuration& c) { c.roulette = true; }});
    for (int split = 1; has_glass && split <= 2; ++split)
        all.push_back({fmt::format("both branches of the first {} hit{} on glass", split, split == 1 ? "" : "s"),
                       Group::Split, [=](Configuration& c) { c.split_depth = split; }});
    return all;
}

}  // namespace raypool::accuracy
