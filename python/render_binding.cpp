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
#include "cli/render_record.h"
#include "cli/stats_json.h"
#include "cli/stopwatch.h"
#include "core/base/error.h"
#include "core/base/json_file.h"
#include "core/runtime/progressive.h"
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
cli::RenderedImage render_in(const Scene& scene, cli::RenderRecord& record, const Watch& watch, bool in_pieces) {
    const CompiledScene<Scalar> compiled = cli::compile_for<Scalar>(record, scene);
    watch.look(0, path_count(compiled, record.settings));
    Framebuffer sums = cli::make_sums(record, compiled);
    record.report = render_into(sums, compiled, record, watch, in_pieces);
    std::vector<ImageChannel> aovs = cli::make_aovs(record, compiled, sums);
    return cli::finish_record(record, scene, std::move(sums), std::move(aovs));
}

/// An array of numpy that has the values of a vector, which are not copied.
py::array_t<float> to_array(std::vector<float> values, const std::vector<std::int64_t>& shape) {
    auto owned = std::make_unique<std::vector<float>>(std::move(values));
    const float* const data = owned->data();
    const py::capsule owner(owned.get(), [](void* object) { delete static_cast<std::vector<float>*>(object); });
    owned.release();
    return py::array_t<float>(shape, data, owner);
}

py::tuple render(const LoadedScene& loaded, std::vector<std::string> arguments, const py::object& progress,
                 bool in_pieces) {
    const ThreadCount keep;
    const Watch watch(progress);
    cli::RenderedImage made;
    std::string stats;
    {
        const py::gil_scoped_release no_gil;
        const cli::Stopwatch total;
        const cli::RenderOptions options = parse(std::move(arguments));
        cli::RenderRecord record = cli::start_record(options);
        const std::shared_ptr<const Scene> scene = sized(loaded.scene, options);
        cli::add_scene(record, *scene, options);
        record.read_s = loaded.read_s;
        std::vector<std::uint32_t> pixels;
        if (options.crop) {
            pixels = cli::pixels_of(record.crop, scene->width);
            record.settings.pixels = &pixels;
        }
        made = record.precision == cli::Precision::Double ? render_in<double>(*scene, record, watch, in_pieces)
                                                          : render_in<float>(*scene, record, watch, in_pieces);
        record.total_s = loaded.read_s + total.seconds();
        stats = json_text(cli::stats_json(record), JsonLayout::OneLine);
    }
    const std::int64_t height = made.image.height;
    const std::int64_t width = made.image.width;
    py::dict channels;
    for (ImageChannel& channel : made.aovs)
        channels[py::str(channel.name)] = to_array(std::move(channel.values), {height, width});
    return py::make_tuple(to_array(std::move(made.image.rgb), {height, width, 3}), stats, channels);
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
