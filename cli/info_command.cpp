#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/print.h"
#include "core/base/memory.h"
#include "core/film/light_range.h"
#include "core/runtime/engine.h"
#include "core/runtime/environment.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"
#include "core/shading/compiled_scene.h"
#include "wavefront/capacity.h"

namespace raypool::cli {

namespace {

/// "1 plane", "2 planes".
std::string counted(std::size_t count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

template <class Block>
std::size_t filled_lanes(std::span<const Block> blocks) {
    std::size_t count = 0;
    for (const Block& block : blocks)
        for (const std::int32_t id : block.id) count += id != kNoPrimitive ? 1 : 0;
    return count;
}

template <class Tree>
void print_tree(const char* what, const Tree& tree) {
    if (tree.nodes.empty()) return;
    const std::size_t lanes = tree.blocks.size() * kTreeWidth<float>;
    print("{} tree: {} nodes {} wide, {} levels, {} leaves holding {} ({:.0f} % full)\n", what, tree.nodes.size(),
          kTreeWidth<float>, tree.depth, tree.blocks.size(), filled_lanes(tree.blocks),
          100.0 * static_cast<double>(filled_lanes(tree.blocks)) / static_cast<double>(lanes));
}

/// "quad 2": the third of its kind in the scene file.
std::string place_of(const Scene& scene, std::size_t id) {
    if (id < scene.spheres.size()) return fmt::format("sphere {}", id);
    id -= scene.spheres.size();
    if (id < scene.quads.size()) return fmt::format("quad {}", id);
    return fmt::format("plane {}", id - scene.quads.size());
}

/// Shapes that no ray meets, since a single one listed before covers them: more likely a mistake than meant.
void print_hidden(const Scene& scene, const std::vector<bool>& is_hidden) {
    constexpr std::ptrdiff_t kMostNamed = 5;
    std::vector<std::string> named;
    const auto count = std::count(is_hidden.begin(), is_hidden.end(), true);
    for (std::size_t id = 0; id < is_hidden.size() && std::ssize(named) < kMostNamed; ++id)
        if (is_hidden[id]) named.push_back(place_of(scene, id));
    if (count > 0)
        print("hidden in float: {} shapes, each by one listed before: {}{}\n", count, fmt::join(named, ", "),
              count > kMostNamed ? ", ..." : "");
}

/// How many of the meshes are instances, and how many triangles stand for theirs.
std::string instances_text(const Scene& scene) {
    std::size_t instances = 0;
    std::size_t triangles = 0;
    for (const MeshShape& shape : scene.meshes) {
        if (!scene.is_instance(shape)) continue;
        ++instances;
        triangles += shape.mesh->triangles.size();
    }
    return instances == 0 ? "" : fmt::format("; {} of them instances, which show {} triangles", instances, triangles);
}

void info(const std::string& name) {
    const Scene scene = load_scene(name);
    const Coincidence coincidence = find_coincidence<float>(scene);
    const CompiledScene<float> compiled = compile<float>(scene, coincidence);
    const auto listed = [](const Features& features) {
        const auto names = feature_names(features);
        return names.empty() ? std::string("nothing") : fmt::format("{}", fmt::join(names, ", "));
    };
    print("{}: {}\n", scene.name, scene.description);
    print("image: {} x {}\n", scene.width, scene.height);
    print("shapes: {}, {}, {}; {}, {} or colours\n", counted(scene.spheres.size(), "sphere"),
          counted(scene.quads.size(), "quad"), counted(scene.planes.size(), "plane"),
          counted(scene.materials.size(), "material"), counted(scene.textures.size(), "texture"));
    if (!scene.meshes.empty())
        print("meshes: {}, of {} triangles and {} vertices{}\n", scene.meshes.size(), compiled.triangles.size(),
              compiled.vertices.size(), instances_text(scene));
    print_hidden(scene, coincidence.is_hidden);
    print("features of the scene: {}\n", listed(compiled.features));
    const auto code = [](const Features& features, std::size_t first) {
        return kCompiledFeatures[compiled_features_index(features, first)];
    };
    print("features of the code that runs it, the smallest set compiled that has them all: {}; in double: {}\n",
          listed(code(compiled.features, kFirstCompiledFeatures<float>)),
          listed(code(compiled.features, kFirstCompiledFeatures<double>)));
    const CodeWidths widths = code_widths();
    print("that code may use: {}; stages of {} rays in float, {} in double; trees {} and {} wide\n",
          fmt::format("{}", fmt::join(widths.instruction_sets, ", ")), widths.float_lanes, widths.double_lanes,
          widths.float_tree_width, widths.double_tree_width);
    Features without_lights = compiled.features;
    without_lights.lights = false;
    const auto record_bytes = [&]<class Scalar>(const Features& features, Scalar) {
        return ray_record_bytes(code(features, kFirstCompiledFeatures<Scalar>), sizeof(Scalar));
    };
    print("ray record: {} bytes in float, {} in double{}\n", record_bytes(compiled.features, float{}),
          record_bytes(compiled.features, double{}),
          compiled.features.lights
              ? fmt::format("; {} and {} without light sampling", record_bytes(without_lights, float{}),
                            record_bytes(without_lights, double{}))
              : "");
    print("tested before the trees: {}, {}\n", counted(filled_lanes(compiled.large_spheres), "sphere"),
          counted(filled_lanes(compiled.planes), "plane"));
    print_tree("sphere", compiled.sphere_tree);
    print_tree("quad", compiled.quad_tree);
    print_tree("triangle", compiled.triangle_tree);
    print_tree("object", compiled.instance_tree.objects);
    if (!compiled.instance_tree.nodes.empty())
        print("instance tree: {} nodes, depth {}\n", compiled.instance_tree.nodes.size(), compiled.instance_tree.depth);
    print("pool of a thread: {} records, for trees of {} and a second-level cache of {}\n",
          wavefront::pool_capacity(wavefront::PoolSettings{}, compiled, 1), bytes_text(wavefront::tree_bytes(compiled)),
          bytes_text(second_level_cache()));
    ImageSettings settings;  // as a render has them that is told nothing else
    settings.light_sampling = parse_light_sampling(CommonOptions().light_sampling);
    const FixedPoint fixed = fixed_point(compiled, settings, 1);
    print("light: radiance {:.3g} to {:.3g}; sums of up to {} samples go by steps of {:.2g}{}\n", dimmest_light(scene),
          compiled.max_radiance, FixedPoint::kExtensibleSamples, 1 / fixed.scale(),
          rounding_of(dimmest_light(scene), fixed) > kFineStep ? ", coarse for the dimmest" : "");
    print("tables: {:.1f} KB\n", static_cast<double>(compiled.bytes()) / 1024);
}

}  // namespace

void add_info_command(CLI::App& app, int&) {
    auto scene = std::make_shared<std::string>("paper");
    CLI::App* command = app.add_subcommand("info", "Say which features a scene uses, and how its tables came out");
    command->add_option("scene", *scene, "Scene file, or the name of a built-in scene (default: paper)");
    command->callback([scene] { info(*scene); });
}

}  // namespace raypool::cli
