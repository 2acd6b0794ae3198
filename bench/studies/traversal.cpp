// How fast hits are found, apart from all else: single rays, packets and streams of ours, and Embree, on the same rays.

#include <fmt/format.h>

#include "bench/studies/registry.h"
#include "bench/studies/traced_scene.h"
#include "wavefront/capacity.h"

namespace raypool::studies {

namespace {

/// One search, made when it first runs: Embree's trees take longer than the rays.
struct TracedSearch {
    std::string kind;
    std::int64_t triangles;
    NamedSearch search;
    std::shared_ptr<Lazy<TracedScene>> scene;
    std::shared_ptr<Lazy<RaySearch>> made;

    [[nodiscard]] std::vector<Cells> rows(std::size_t ray_kind) const {
        const TracedRays& traced = (*scene)().kinds[ray_kind];
        const TimedSearch timed = time_search((*made)(), traced, search.is_ours,
                                              fmt::format("{}, {} triangles: {}", kind, triangles, search.name));
        return {{{"kind", kind},
                 {"triangles", triangles},
                 {"tree_bytes", wavefront::tree_bytes((*scene)().scene->compiled)},
                 {"rays", traced.rays.kind},
                 {"search", search.name},
                 {"ray_count", traced.rays.count},
                 {"seconds", timed.seconds},
                 {"mrays_per_s", timed.mrays_per_s(traced)},
                 {"others", timed.others},
                 {"far_apart", traced.rays.are_shadow ? Value() : Value(timed.far_apart)}}};
    }
};

std::vector<Case> traversal_cases(const StudyOptions& options) {
    const Plan plan = plan_of(options, {1, 1}, {3, 7}, 1);
    const std::int64_t width = choose(options, options.width, {128, 512});
    std::vector<std::int64_t> sizes{1000, 10'000};
    std::vector<std::string> kinds{"field"};
    std::vector<std::size_t> capacities{8192};
    if (!options.is_quick) {
        sizes.insert(sizes.end(), {100'000, 1'000'000, 10'000'000});
        kinds.insert(kinds.end(), {"room", "terrain"});
        capacities.insert(capacities.end(), {32'768, 131'072});
    }

    std::vector<Case> cases;
    const auto add = [&](const std::string& kind, std::int64_t triangles, const LazyTracedScene& scene) {
        for (const NamedSearch& search : named_searches(capacities)) {
            const auto made =
                std::make_shared<Lazy<RaySearch>>([=, make = search.make] { return make((*scene)().scene->compiled); });
            const TracedSearch traced{kind, triangles, search, scene, made};
            for (std::size_t i = 0; i < kRayKinds.size(); ++i) {
                if (i + 1 == kRayKinds.size() && !search.has_shadow_rays) continue;
                cases.push_back({fmt::format("{} {}, {} rays: {}", triangles, kind, kRayKinds[i], search.name), "",
                                 plan.repeats, [=] { return traced.rows(i); }});
            }
        }
    };
    for_each_traced_scene(kinds, sizes, width, plan.settings, add);
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
