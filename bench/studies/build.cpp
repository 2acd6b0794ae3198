// How fast trees over triangles are built, and what they are worth to rays: ours, ours by Embree's builder, Embree's.

#include <omp.h>

#include <algorithm>
#include <optional>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/peak_memory.h"
#include "bench/studies/registry.h"
#include "bench/studies/traced_scene.h"
#include "bench/studies/tree_quality.h"
#include "core/base/clock.h"

#ifdef RAYPOOL_HAS_EMBREE
#include "bench/peers/embree_bvh.h"
#endif

namespace raypool::studies {

namespace {

using Tree = TriangleTree<float>;

/// A tree, and how long it took.
struct Built {
    double seconds = 0;
    std::optional<double> binary_seconds = std::nullopt;
    std::size_t bytes = 0;
    std::shared_ptr<const Tree> tree = nullptr;  ///< that our traversal walks
    RaySearch search = nullptr;                  ///< where it walks none
};

struct Builder {
    std::string name;
    std::function<Built(const CompiledScene<float>& scene, int threads)> build;
};
constexpr const char* kOurs = "ours";

/// What OpenMP gives a parallel region that asks for nothing.
class DefaultThreads {
  public:
    explicit DefaultThreads(int count) : before_(omp_get_max_threads()) {
        omp_set_num_threads(count);
        int given = 0;
#pragma omp parallel
#pragma omp single
        given = omp_get_num_threads();
        check_threads(given, count);
    }
    ~DefaultThreads() {
        omp_set_num_threads(before_);
    }
    DefaultThreads(const DefaultThreads&) = delete;
    DefaultThreads& operator=(const DefaultThreads&) = delete;

  private:
    int before_;
};

/// By compile()'s own steps, of which `build`, which says how long it took, makes the binary tree. What it does beside,
/// to call a library and to turn that one's tree into ours, is not in the time.
Built build_ours(const CompiledScene<float>& scene,
                 const std::function<BinaryBvh(const std::vector<Box>&, std::uint32_t, double&)>& build) {
    const TriangleRows rows{0, static_cast<std::uint32_t>(scene.first_instanced - scene.first_triangle)};
    double inside = 0;
    double binary = 0;
    const double start = wall_seconds();
    auto tree = std::make_shared<Tree>(triangle_tree(scene.tables(), rows, scene.first_triangle,
                                                     [&](const std::vector<Box>& boxes, std::uint32_t block) {
                                                         const double before = wall_seconds();
                                                         BinaryBvh made = build(boxes, block, binary);
                                                         inside = wall_seconds() - before;
                                                         return made;
                                                     }));
    const double seconds = wall_seconds() - start - inside + binary;
    const std::size_t bytes =
        tree->nodes.size() * sizeof(tree->nodes[0]) + tree->blocks.size() * sizeof(tree->blocks[0]);
    return {seconds, binary, bytes, std::move(tree)};
}

BinaryBvh timed_binary_bvh(const std::vector<Box>& boxes, std::uint32_t block, double& seconds) {
    const double start = wall_seconds();
    BinaryBvh tree = build_binary_bvh(boxes, block);
    seconds = wall_seconds() - start;
    return tree;
}

#ifdef RAYPOOL_HAS_EMBREE
Builder embree_builder(const char* name, RTCSceneFlags flags) {
    return {name, [flags](const CompiledScene<float>& scene, int threads) -> Built {
                const auto embree = embree_scene(scene, {flags, threads});
                return {.seconds = embree->build_seconds(),
                        .bytes = embree->bytes(),
                        .search = embree_single_rays(scene, embree)};
            }};
}
#endif

std::vector<Builder> builders(int threads) {
    std::vector<Builder> all{
        {kOurs, [](const CompiledScene<float>& scene, int) { return build_ours(scene, timed_binary_bvh); }}};
#ifdef RAYPOOL_HAS_EMBREE
    if (threads > core_count()) return all;  // Embree takes no more
    all.push_back({"embree-sah", [](const CompiledScene<float>& scene, int asked) {
                       return build_ours(scene, [&](const auto& boxes, std::uint32_t block, double& seconds) {
                           peers::EmbreeBvh bvh = peers::embree_bvh(boxes, block, asked);
                           seconds = bvh.seconds;
                           return std::move(bvh.tree);
                       });
                   }});
    all.push_back(embree_builder("embree-robust", RTC_SCENE_FLAG_ROBUST));
    all.push_back(embree_builder("embree-split", RTC_SCENE_FLAG_NONE));
#else
    (void)threads;
#endif
    return all;
}

template <class T>
bool has_same_bytes(const T& a, const T& b) {
    return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}
/// To the bit, but for padding.
bool is_same(const Tree& a, const Tree& b) {
    return std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(),
                      [](const auto& x, const auto& y) {
                          return has_same_bytes(x.bounds, y.bounds) && has_same_bytes(x.child, y.child);
                      }) &&
           std::equal(a.blocks.begin(), a.blocks.end(), b.blocks.begin(), b.blocks.end(),
                      [](const auto& x, const auto& y) {
                          return has_same_bytes(x.vertex, y.vertex) && has_same_bytes(x.id, y.id);
                      });
}

/// The name of the column of a kind of rays.
std::string rate_column(std::string rays) {
    std::replace(rays.begin(), rays.end(), ' ', '_');
    return rays + "_mrays_per_s";
}

std::vector<Cells> built_rows(const std::string& kind, const TracedScene& traced, const Builder& builder, int threads) {
    const CompiledScene<float>& scene = traced.scene->compiled;
    const std::string who = fmt::format("{}: {}, {} threads", traced.scene->name, builder.name, threads);
    Built built;
    std::optional<std::size_t> peak;
    {
        const DefaultThreads scope(threads);
        peak = peak_growth([&] { built = builder.build(scene, threads); });
    }
    Cells cells{{"kind", kind},
                {"triangles", scene.triangles.size()},
                {"builder", builder.name},
                {"threads", threads},
                {"seconds", built.seconds},
                {"binary_seconds", built.binary_seconds ? Value(*built.binary_seconds) : Value()},
                {"mtriangles_per_s", 1e-6 * static_cast<double>(scene.triangles.size()) / built.seconds},
                {"tree_bytes", built.bytes},
                {"peak_bytes", peak ? Value(*peak) : Value()}};
    auto view = static_cast<const SceneView<float>&>(scene);
    if (built.tree != nullptr) {
        if (builder.name == kOurs && !is_same(*built.tree, scene.tables().triangle_tree))
            throw std::runtime_error(who + " built another tree than compile()");
        view.triangle_tree = TreeView(*built.tree);
        built.search = single_rays(view);
        const TreeQuality quality = tree_quality(*built.tree);
        cells = std::move(cells) + Cells{{"node_visits", quality.nodes},
                                         {"leaf_visits", quality.leaves},
                                         {"leaf_fill", quality.leaf_fill},
                                         {"depth", built.tree->depth}};
    }
    for (const TracedRays& rays : traced.kinds) {
        const TimedSearch timed = time_search(built.search, rays, built.tree != nullptr, who);
        cells.emplace_back(rate_column(rays.rays.kind), timed.mrays_per_s(rays));
    }
    return {cells};
}

std::vector<Case> build_cases(const StudyOptions& options) {
    const Plan plan = plan_of(options, {1, 1}, {3, 5}, core_count());
    const std::int64_t width = choose(options, options.width, {128, 512});
    const std::vector<std::string> kinds{"field", "terrain"};
    const std::vector<std::int64_t> sizes = options.is_quick
                                                ? std::vector<std::int64_t>{1000, 10'000}
                                                : std::vector<std::int64_t>{10'000, 100'000, 1'000'000, 10'000'000};

    std::vector<Case> cases;
    const auto add = [&](const std::string& kind, std::int64_t triangles, const LazyTracedScene& scene) {
        for (const int threads : one_and_all(plan.most_threads))
            for (const Builder& builder : builders(threads))
                cases.push_back({fmt::format("{} {}: {}, {} threads", triangles, kind, builder.name, threads), "",
                                 plan.repeats, [=] { return built_rows(kind, (*scene)(), builder, threads); }});
    };
    for_each_traced_scene(kinds, sizes, width, plan.settings, add);
    return cases;
}

std::vector<Column> build_columns() {
    std::vector<Column> columns{
        {"kind", ColumnType::Text, "of mesh, made by scenes/generate_mesh"},
        {"triangles", ColumnType::Count, "how many"},
        {"builder", ColumnType::Text,
         "ours; embree-sah: our tree, but for the binary tree by rtcBuildBVH; embree-robust: a scene of Embree's own "
         "triangles; embree-split: one that is not robust, for which Embree splits triangles between leaves"},
        {"threads", ColumnType::Count, "that build"},
        {"seconds", ColumnType::Real,
         "wall clock, from vertices to a tree to be traced; of Embree's scenes: rtcCommitScene"},
        {"binary_seconds", ColumnType::Real, "of these, for the binary tree; empty for Embree's scenes"},
        {"mtriangles_per_s", ColumnType::Real, "million triangles a second"},
        {"tree_bytes", ColumnType::Count, "nodes and leaves; of Embree's scenes: what Embree says that it keeps"},
        {"peak_bytes", ColumnType::Count,
         "most memory at once beyond vertices, which triangles have them, and what the process had; the tree is in it"},
        {"node_visits", ColumnType::Real,
         "nodes that a random line through the root's box meets; empty for Embree's scenes"},
        {"leaf_visits", ColumnType::Real, "leaves that it meets, of a block of triangles each"},
        {"leaf_fill", ColumnType::Real, "triangles of a leaf, of those that it has room for"},
        {"depth", ColumnType::Count, "levels of nodes"}};
    for (const char* rays : kRayKinds)
        columns.push_back({rate_column(rays), ColumnType::Real,
                           fmt::format("million {} rays a second in one thread, by single rays", rays)});
    return columns;
}

}  // namespace

Study build_study() {
    return {
        .name = "build",
        .question = "How fast are trees over triangles built, by us and by Embree, and what are they worth to rays?",
        .columns = build_columns(),
        .cases = build_cases};
}

}  // namespace raypool::studies
