// How fast hits are found, apart from all else: single rays, packets and streams of ours, and Embree, on the same rays.

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/generated_scene.h"
#include "bench/studies/recorded_rays.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/traversal_searches.h"
#include "core/base/clock.h"
#include "wavefront/capacity.h"

namespace raypool::studies {

namespace {

/// A scene with the rays of its render, and what each meets by single rays of ours.
struct TracedScene {
    struct Rays {
        RecordedRays rays;
        RayAnswers answers;
    };
    std::shared_ptr<const StudyScene> scene;
    std::vector<Rays> kinds;

    TracedScene(const std::string& kind, std::int64_t triangles, std::int64_t width, const RenderSettings& settings)
        : scene(generated_scene(kind, triangles, width)) {
        const RaySearch single = named_searches({}).front().make(scene->compiled);
        for (RecordedRays& rays : record_rays(scene->compiled, settings)) {
            if (rays.count == 0) throw std::runtime_error(fmt::format("{} has no {} rays", scene->name, rays.kind));
            RayAnswers answers(rays.count);
            single(rays, answers);
            kinds.push_back({std::move(rays), std::move(answers)});
        }
    }
};

/// Answers that are not the expected ones.
struct OtherAnswers {
    std::int64_t all = 0;
    std::int64_t far_apart = 0;  ///< of these, of closest hits: at distances that do not agree to 1/10,000
};

OtherAnswers other_answers(const RayAnswers& found, const RayAnswers& expected, bool are_shadow) {
    constexpr float kTie = 1e-4F;
    OtherAnswers others;
    for (std::size_t i = 0; i < expected.primitive_id.size(); ++i) {
        if (found.primitive_id[i] == expected.primitive_id[i]) continue;
        ++others.all;
        if (!are_shadow && !(std::abs(found.distance[i] - expected.distance[i]) <= kTie * expected.distance[i]))
            ++others.far_apart;
    }
    return others;
}

/// One search, made when it first runs: Embree's trees take longer than the rays.
struct TracedSearch {
    std::string kind;
    std::int64_t triangles;
    NamedSearch search;
    std::shared_ptr<Lazy<TracedScene>> scene;
    std::shared_ptr<Lazy<RaySearch>> made;

    [[nodiscard]] std::vector<Cells> rows(std::size_t ray_kind) const {
        const auto& [rays, expected] = (*scene)().kinds[ray_kind];
        const RaySearch& trace = (*made)();
        RayAnswers found(rays.count);
        const double start = wall_seconds();
        trace(rays, found);
        const double seconds = wall_seconds() - start;

        const OtherAnswers others = other_answers(found, expected, rays.are_shadow);
        const bool is_same = others.all == 0 && (rays.are_shadow || found.distance == expected.distance);
        constexpr std::int64_t kRaysForOneOther = 1000;
        if (search.is_ours ? !is_same : others.all * kRaysForOneOther > static_cast<std::int64_t>(rays.count))
            throw std::runtime_error(fmt::format("{} triangles, {}: of {} {} rays {} got another answer from {}",
                                                 triangles, kind, rays.count, rays.kind, others.all, search.name));
        return {{{"kind", kind},
                 {"triangles", triangles},
                 {"tree_bytes", wavefront::tree_bytes((*scene)().scene->compiled)},
                 {"rays", rays.kind},
                 {"search", search.name},
                 {"ray_count", rays.count},
                 {"seconds", seconds},
                 {"mrays_per_s", 1e-6 * static_cast<double>(rays.count) / seconds},
                 {"others", others.all},
                 {"far_apart", rays.are_shadow ? Value() : Value(others.far_apart)}}};
    }
};

std::vector<Case> traversal_cases(const StudyOptions& options) {
    const Plan plan = plan_of(options, {1, 1}, {3, 7}, 1);
    const std::int64_t width = choose(options, options.width, {128, 512});
    constexpr std::int64_t kLargestOfAll = 1'000'000;
    std::vector<std::int64_t> sizes{1000, 10'000};
    std::vector<std::string> kinds{"field"};
    std::vector<std::size_t> capacities{8192};
    if (!options.is_quick) {
        sizes.insert(sizes.end(), {100'000, 1'000'000, 10'000'000});
        kinds.insert(kinds.end(), {"room", "terrain"});
        capacities.insert(capacities.end(), {32'768, 131'072});
    }

    std::vector<Case> cases;
    for (const std::string& kind : kinds) {
        for (const std::int64_t triangles : sizes) {
            // All scenes are kept until the end, with Embree's trees: a few gigabytes at this size.
            if (triangles > kLargestOfAll && kind != kinds.front()) continue;
            const auto scene = std::make_shared<Lazy<TracedScene>>(
                [=, settings = plan.settings] { return TracedScene(kind, triangles, width, settings); });
            for (const NamedSearch& search : named_searches(capacities)) {
                const auto made = std::make_shared<Lazy<RaySearch>>(
                    [=, make = search.make] { return make((*scene)().scene->compiled); });
                const TracedSearch traced{kind, triangles, search, scene, made};
                for (std::size_t i = 0; i < kRayKinds.size(); ++i) {
                    if (i + 1 == kRayKinds.size() && !search.has_shadow_rays) continue;
                    cases.push_back({fmt::format("{} {}, {} rays: {}", triangles, kind, kRayKinds[i], search.name), "",
                                     plan.repeats, [=] { return traced.rows(i); }});
                }
            }
        }
    }
    return cases;
}

}  // namespace

Study traversal_study() {
    return {
        .name = "traversal",
        .question = "How fast are hits found by our searches and by Embree's, on the same rays?",
        .columns = {{"kind", ColumnType::Text, "of mesh, made by scenes/generate_mesh"},
                    {"triangles", ColumnType::Count, "about how many"},
                    {"tree_bytes", ColumnType::Count, "nodes and leaves of our trees"},
                    {"rays", ColumnType::Text,
                     "which, of a render: from the camera, from the first or the fourth hit of a path, or from "
                     "first hits toward lights (shadow)"},
                    {"search", ColumnType::Text, "how hits are found, in one thread"},
                    {"ray_count", ColumnType::Count, "rays traced"},
                    {"seconds", ColumnType::Real, "wall clock of all rays"},
                    {"mrays_per_s", ColumnType::Real, "million rays a second"},
                    {"others", ColumnType::Count,
                     "rays that met another primitive than single rays of ours, or were hidden where those are not"},
                    {"far_apart", ColumnType::Count,
                     "of these, at distances that do not agree to 1/10,000; empty for shadow rays"}},
        .cases = traversal_cases};
}

}  // namespace raypool::studies
