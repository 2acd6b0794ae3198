#include "cli/render_record.h"

#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "cli/engines.h"
#include "cli/options.h"
#include "cli/stopwatch.h"
#include "core/base/error.h"
#include "core/base/memory.h"
#include "core/film/light_range.h"
#include "core/runtime/aovs.h"
#include "gpu/engine.h"

namespace raypool::cli {

namespace {

/// Sums, the image made of them and, where asked for, costs with their image, a second half of the sums with estimates
/// and the checkpoint's bytes must fit into the memory that is available, before anything is touched. So must channels
/// of the pixels that are shown, with the file's bytes.
void check_memory(const RenderRecord& record, const RenderOptions& options, int process_count) {
    std::size_t pixel_bytes = 3 * (sizeof(std::int64_t) + sizeof(float));
    if (!options.cost_image.empty()) pixel_bytes += sizeof(std::int64_t) + 3 * sizeof(float);
    if (record.target_error > 0)
        pixel_bytes += 3 * sizeof(std::int64_t) + 3 * sizeof(std::int32_t) + 2 * sizeof(double);
    if (record.has_aovs) pixel_bytes += 3 * sizeof(std::int64_t);
    if (!options.checkpoint.file.empty()) pixel_bytes += 6 * sizeof(std::int64_t) + sizeof(std::int32_t);
    constexpr std::size_t kAovBytes = 12 * sizeof(float) + 15 * sizeof(float) + 10 * sizeof(std::int16_t);
    const PixelWindow& crop = record.crop;
    const std::int64_t shown = (crop.x_end - crop.x_begin) * (crop.y_end - crop.y_begin);
    const std::size_t bytes = static_cast<std::size_t>(record.width * record.height) * pixel_bytes +
                              static_cast<std::size_t>(shown) * (record.has_aovs ? kAovBytes : 0);
    check_available(bytes * static_cast<std::size_t>(process_count),
                    fmt::format("--width: the sums and images of {} x {} pixels", record.width, record.height));
}

PixelWindow crop_of(const RenderOptions& options, const Scene& scene) {
    if (options.crop) return parse_window(*options.crop, "--crop", scene.width, scene.height);
    if (options.pixel) return parse_pixel(*options.pixel, "--pixel", scene.width, scene.height);
    return {0, scene.width, 0, scene.height};
}

/// Of the code that a scene runs on, which may be compiled for more than it needs.
std::size_t stored_record_bytes(const Features& needed, Precision precision) {
    const bool is_double = precision == Precision::Double;
    const std::size_t first = is_double ? kFirstCompiledFeatures<double> : kFirstCompiledFeatures<float>;
    return ray_record_bytes(kCompiledFeatures[compiled_features_index(needed, first)],
                            is_double ? sizeof(double) : sizeof(float));
}

}  // namespace

RenderRecord start_record(const RenderOptions& options) {
    RenderRecord record;
    record.settings = render_settings(options);
    record.spp = options.spp;
    record.precision = options.precision == "double" ? Precision::Double : Precision::Float;
    record.engine = options.engine;
    record.target_error = options.target_error;
    record.has_aovs = options.has_aovs;
    if (options.target_error > 0 && options.spp < 2)
        throw InputError("--spp: must be at least 2 with --target-error: one sample does not tell its error");
    return record;
}

void add_scene(RenderRecord& record, const Scene& scene, const RenderOptions& options, int process_count) {
    record.scene_name = scene.name;
    record.width = scene.width;
    record.height = scene.height;
    record.crop = crop_of(options, scene);
    check_memory(record, options, process_count);
    const Features needed = needed_features(scene_features(scene), record.settings);
    record.pool = pool_settings(options.pool, stored_record_bytes(needed, record.precision), record.settings.threads);
    record.gpu = gpu_settings(options, gpu::pool_record_bytes(needed));
}

template <class Scalar>
CompiledScene<Scalar> compile_for(RenderRecord& record, const Scene& scene) {
    const Stopwatch watch;
    CompiledScene<Scalar> compiled = compile<Scalar>(scene);
    record.features = compiled.features;
    record.settings.light_sampling = needed_light_sampling(compiled.features, record.settings);
    record.truncation_bound = compiled.truncation_bound(record.settings.depth);
    record.compile_s = watch.seconds();
    return compiled;
}

template <class Scalar>
Framebuffer make_sums(const RenderRecord& record, const CompiledScene<Scalar>& scene) {
    return {scene.width, scene.height, fixed_point(scene, record.settings, record.spp),
            record.target_error > 0 || record.has_aovs ? Halves::Apart : Halves::Together};
}

template <class Scalar>
std::vector<ImageChannel> make_aovs(RenderRecord& record, const CompiledScene<Scalar>& compiled,
                                    const Framebuffer& sums) {
    if (!record.has_aovs) return {};
    const Stopwatch watch;
    const ImageSamples samples{record.crop, record.settings.first_sample, record.settings.end_sample,
                               record.adaptive.sample_counts};
    std::vector<ImageChannel> channels =
        first_hit_channels(compiled, record.settings, samples, record.settings.threads);
    for (ImageChannel& channel : variance_channels(sums, samples)) channels.push_back(std::move(channel));
    record.aovs_s = watch.seconds();
    return channels;
}

RenderedImage finish_record(RenderRecord& record, const Scene& scene, Framebuffer sums,
                            std::vector<ImageChannel> aovs) {
    const bool is_adaptive = record.target_error > 0;
    RenderedImage made{{}, std::move(aovs)};
    record.sum_step = 1 / sums.fixed_point().scale();
    record.dimmest_light = dimmest_light(scene);
    if (is_cropped(record)) sums = sums.cut(record.crop);
    if (record.has_aovs && !is_adaptive) sums = sums.together();  // the hash is of what was asked for
    record.hash = sums.hash();
    Image& image = made.image;
    image = is_adaptive ? sums.image(record.adaptive.sample_counts) : sums.image(record.samples_done);
    record.mean_radiance =
        std::accumulate(image.rgb.begin(), image.rgb.end(), 0.0) / static_cast<double>(image.rgb.size());
    return made;
}

template CompiledScene<float> compile_for(RenderRecord&, const Scene&);
template CompiledScene<double> compile_for(RenderRecord&, const Scene&);
template Framebuffer make_sums(const RenderRecord&, const CompiledScene<float>&);
template Framebuffer make_sums(const RenderRecord&, const CompiledScene<double>&);
template std::vector<ImageChannel> make_aovs(RenderRecord&, const CompiledScene<float>&, const Framebuffer&);
template std::vector<ImageChannel> make_aovs(RenderRecord&, const CompiledScene<double>&, const Framebuffer&);

}  // namespace raypool::cli
