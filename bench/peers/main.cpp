// raypool_peer_embree: renders a scene with the peer alone, and says how fast it was.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include <embree3/rtcore_config.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/peers/embree_path_tracer.h"
#include "core/runtime/environment.h"
#include "core/base/error.h"
#include "core/image/image_file.h"
#include "core/base/json_file.h"
#include "core/scene/scene_reader.h"
#include "core/base/text.h"

namespace {

using namespace raypool;
using namespace raypool::peers;

nlohmann::json to_json(const Scene& scene, const PeerSettings& settings, const PeerReport& report) {
    return {{"peer", fmt::format("embree {}", RTC_VERSION_STRING)},
            {"mode", settings.mode == PeerMode::Single ? "single" : "packet"},
            {"packet_width", settings.mode == PeerMode::Single ? 1 : packet_width()},
            {"scene", scene.name},
            {"width", scene.width},
            {"height", scene.height},
            {"spp", settings.spp},
            {"depth", settings.depth},
            {"seed", settings.seed},
            {"threads", settings.threads},
            {"paths", report.paths},
            {"segments", report.segments},
            {"seconds", {{"build", report.build_s}, {"render", report.seconds}}},
            {"mpaths_per_s", static_cast<double>(report.paths) / report.seconds * 1e-6},
            {"environment", environment_json()}};
}

int run(int argc, char** argv) {
    std::string scene_name = "paper";
    std::string output;
    std::string json_file;
    std::string mode = "packet";
    std::int64_t width = 0;
    PeerSettings settings;
    settings.spp = 100;
    CLI::App app("The Embree path tracer that raypool is measured against.", "raypool_peer_embree");
    app.add_option("scene", scene_name, "Scene file, or the name of a built-in scene")->capture_default_str();
    app.add_option("--spp", settings.spp, "Samples a pixel")->check(CLI::Range(1, 1 << 30))->capture_default_str();
    app.add_option("--width", width, "Width in pixels; the height follows")->check(CLI::Range(1, 65536));
    app.add_option("--depth", settings.depth, "Most segments of a path")
        ->check(CLI::Range(0, 1 << 30))
        ->capture_default_str();
    app.add_option("--seed", settings.seed, "Seed of the random numbers")->capture_default_str();
    app.add_option("--threads", settings.threads, "Threads")->check(CLI::Range(1, 4096))->capture_default_str();
    app.add_option("--mode", mode, "One path at a time or packets of them")
        ->check(CLI::IsMember({"single", "packet"}))
        ->capture_default_str();
    app.add_option("-o,--output", output, "Image to write: .png, .exr or .pfm");
    app.add_option("--json", json_file, "File for the figures");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }

    settings.mode = mode == "single" ? PeerMode::Single : PeerMode::Packet;
    Scene scene = load_scene(scene_name);
    if (width > 0) {
        scene.height = std::max<std::int64_t>(1, scene.height * width / scene.width);
        scene.width = width;
    }
    if (!output.empty()) image_format(output);
    Image image;
    const PeerReport report = render_embree(scene, settings, image);
    const auto paths = static_cast<double>(report.paths);
    fmt::print("{}: {} x {}, {} spp, embree {}: {:.3f} M paths, {:.3f} segments a path, {:.3f} s: {:.3f} M paths/s\n",
               printable(scene.name), scene.width, scene.height, settings.spp, RTC_VERSION_STRING, paths * 1e-6,
               static_cast<double>(report.segments) / paths, report.seconds, paths / report.seconds * 1e-6);
    if (!output.empty()) write_image(output, image, {});
    if (!json_file.empty()) {
        write_json(json_file, to_json(scene, settings, report));
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const InputError& error) {
        fmt::print(stderr, "raypool_peer_embree: {}\n", printable(error.what()));
        return 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "raypool_peer_embree: {}\n", printable(error.what()));
        return 1;
    }
}
