#include "python/render_binding.h"

#include <omp.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include "cli/engines.h"
#include "cli/option_rules.h"
#include "cli/options.h"
#include "cli/render_options.h"
#include "cli/stats_json.h"
#include "cli/stopwatch.h"
#include "core/base/error.h"
#include "core/base/json_file.h"
#include "core/base/memory.h"
#include "core/film/light_range.h"
#include "core/runtime/progressive.h"
#include "gpu/engine.h"
#include "python/scene_binding.h"

namespace raypool::python {

namespace py = pybind11;

namespace {

/// OpenMP's number of threads in this thread, which an option of one render sets and the next shall not inherit.
class ThreadCount {
  public:
    ThreadCount() = default;
    ThreadCount(const ThreadCount&) = delete;
    ThreadCount& operator=(const ThreadCount&) = delete;
    ~ThreadCount() { omp_set_num_threads(before_); }

  private:
    int before_ = omp_get_max_threads();
};

/// Asked between pieces of a render, which hold no GIL.
class Watch {
  public:
    explicit Watch(const py::object& progress) : progress_(progress) {}

    /// Throws what a signal's handler, such as that of Ctrl-C, or the callback raises.
    void look(std::int64_t paths, std::int64_t total) const {
        const py::gil_scoped_acquire gil;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress_.is_none()) progress_(paths, total);
    }

  private:
    const py::object& progress_;
};

/// As the command reads and refuses them.
cli::RenderOptions parse(std::vector<std::string> arguments) {
    cli::RenderOptions options;
    CLI::App command("", "render");
    cli::add_render_options(command, options);
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes the last first
    try {
        command.parse(arguments);
    } catch (const CLI::ParseError& error) {
        throw InputError(error.what());
    }
    cli::check_option_rules(command);
    options.engine = cli::engine_in_effect(command);
    return options;
}

/// The scene in the size that is asked for: `given` itself where that is its own, else a copy.
std::shared_ptr<const Scene> sized(const std::shared_ptr<const Scene>& given, const cli::RenderOptions& options) {
    if (options.width == 0 && options.height == 0) return given;
    auto scene = std::make_shared<Scene>(*given);
    set_size(*scene, options.width, options.height);
    return scene;
}

void check_memory(const Scene& scene, bool is_adaptive) {
    std::size_t pixel_bytes = 3 * (sizeof(std::int64_t) + sizeof(float));
    if (is_adaptive) pixel_bytes += 3 * sizeof(std::int64_t) + 3 * sizeof(std::int32_t) + 2 * sizeof(double);
    check_available(static_cast<std::size_t>(scene.width * scene.height) * pixel_bytes,
                    fmt::format("--width: the sums and images of {} x {} pixels", scene.width, scene.height));
}

/// All that is known of a render before its scene is compiled.
cli::RenderRecord make_record(const Scene& scene, const cli::RenderOptions& options) {
    cli::RenderRecord record;
    record.settings = cli::render_settings(options);
    record.spp = options.spp;
    record.precision = options.precision == "double" ? cli::Precision::Double : cli::Precision::Float;
    record.engine = options.engine;
    record.target_error = options.target_error;
    if (options.target_error > 0 && options.spp < 2)
        throw InputError("--spp: must be at least 2 with --target-error: one sample does not tell its error");
    check_memory(scene, options.target_error > 0);
    const bool is_double = record.precision == cli::Precision::Double;
    const Features needed = needed_features(scene_features(scene), record.settings);
    const std::size_t first = is_double ? kFirstCompiledFeatures<double> : kFirstCompiledFeatures<float>;
    const std::size_t record_bytes = ray_record_bytes(kCompiledFeatures[compiled_features_index(needed, first)],
                                                      is_double ? sizeof(double) : sizeof(float));
    record.pool = cli::pool_settings(options.pool, record_bytes, record.settings.threads);
    record.gpu = cli::gpu_settings(options, gpu::pool_record_bytes(needed));
    record.scene_name = scene.name;
    record.width = scene.width;
    record.height = scene.height;
    record.crop = options.crop ? cli::parse_window(*options.crop, "--crop", scene.width, scene.height)
                               : PixelWindow{0, scene.width, 0, scene.height};
    return record;
}

/// Renders into the framebuffer; in pieces, or asking `watch` at the end alone.
template <class Scalar>
RenderReport render_into(Framebuffer& framebuffer, const CompiledScene<Scalar>& compiled, cli::RenderRecord& record,
                         const Watch& watch, bool in_pieces) {
    const RenderSettings& settings = record.settings;
    const std::unique_ptr<Engine> engine = cli::engines().find(record.engine).make(cli::engine_options(record));
    if (record.target_error > 0) {
        AdaptivePlan plan({record.target_error, greatest_sample(compiled, settings), settings.end_sample},
                          compiled.width, compiled.height);
        RenderReport report = render_adaptively(*engine, compiled, settings, plan, framebuffer, [&] {
            const auto& counts = plan.sample_counts();
            watch.look(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}), path_count(compiled, settings));
            return true;
        });
        record.adaptive = plan.report();
        record.samples_done = std::llround(record.adaptive.mean_samples());
        return report;
    }
    record.samples_done = settings.end_sample - settings.first_sample;
    const auto look = [&](std::int64_t end_sample) {
        watch.look(path_count(compiled, RenderUnit{settings.first_sample, end_sample, settings.pixels}),
                   path_count(compiled, settings));
        return true;
    };
    const std::unique_ptr<RenderSession> session = engine->begin(compiled, settings, framebuffer);
    if (in_pieces) {
        render_in_pieces(*session, settings, [&](const SampleRange& piece) { return look(piece.end); });
    } else {
        session->add({settings.first_sample, settings.end_sample, settings.pixels});
        look(settings.end_sample);
    }
    return session->finish();
}

template <class Scalar>
Image render_in(const Scene& scene, cli::RenderRecord& record, const Watch& watch, bool in_pieces) {
    cli::Stopwatch stopwatch;
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
    record.features = compiled.features;
    record.settings.light_sampling = needed_light_sampling(compiled.features, record.settings);
    record.truncation_bound = compiled.truncation_bound(record.settings.depth);
    record.compile_s = stopwatch.lap();
    watch.look(0, path_count(compiled, record.settings));

    const bool is_adaptive = record.target_error > 0;
    Framebuffer framebuffer(compiled.width, compiled.height, fixed_point(compiled, record.settings, record.spp),
                            is_adaptive ? Halves::Apart : Halves::Together);
    record.report = render_into(framebuffer, compiled, record, watch, in_pieces);
    record.sum_step = 1 / framebuffer.fixed_point().scale();
    record.dimmest_light = dimmest_light(scene);
    const Framebuffer shown = cli::is_cropped(record) ? framebuffer.cut(record.crop) : std::move(framebuffer);
    record.hash = shown.hash();
    Image image = is_adaptive ? shown.image(record.adaptive.sample_counts) : shown.image(record.samples_done);
    record.mean_radiance =
        std::accumulate(image.rgb.begin(), image.rgb.end(), 0.0) / static_cast<double>(image.rgb.size());
    return image;
}

/// The pixels, which are not copied.
py::array_t<float> to_array(Image image) {
    auto owned = std::make_unique<Image>(std::move(image));
    const Image& pixels = *owned;
    const py::capsule owner(owned.get(), [](void* object) { delete static_cast<Image*>(object); });
    owned.release();
    return py::array_t<float>({pixels.height, pixels.width, std::int64_t{3}}, pixels.rgb.data(), owner);
}

py::tuple render(const LoadedScene& loaded, std::vector<std::string> arguments, const py::object& progress,
                 bool in_pieces) {
    const ThreadCount keep;
    const Watch watch(progress);
    Image image;
    std::string stats;
    {
        const py::gil_scoped_release no_gil;
        const cli::Stopwatch total;
        const cli::RenderOptions options = parse(std::move(arguments));
        const std::shared_ptr<const Scene> scene = sized(loaded.scene, options);
        cli::RenderRecord record = make_record(*scene, options);
        record.read_s = loaded.read_s;
        std::vector<std::uint32_t> pixels;
        if (options.crop) {
            pixels = cli::pixels_of(record.crop, scene->width);
            record.settings.pixels = &pixels;
        }
        image = record.precision == cli::Precision::Double ? render_in<double>(*scene, record, watch, in_pieces)
                                                           : render_in<float>(*scene, record, watch, in_pieces);
        record.total_s = loaded.read_s + total.seconds();
        stats = json_text(cli::stats_json(record), JsonLayout::OneLine);
    }
    return py::make_tuple(to_array(std::move(image)), stats);
}

py::dict engine_descriptions() {
    py::dict result;
    for (const EngineEntry& entry : cli::engines().entries()) result[py::str(entry.name)] = entry.description;
    return result;
}

}  // namespace

void add_render(py::module_& module) {
    module.def("render", &render, py::arg("scene"), py::arg("arguments"), py::arg("progress"), py::arg("in_pieces"));
    module.def("engines", &engine_descriptions, "The engines by name, the default first, each with what it does.");
}

}  // namespace raypool::python
