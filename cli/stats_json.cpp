#include "cli/stats_json.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "cli/engines.h"
#include "cli/pool_options.h"
#include "core/runtime/environment.h"
#include "gpu/engine.h"
#include "wavefront/pool_report.h"

namespace raypool::cli {

using nlohmann::json;

bool is_cropped(const RenderRecord& record) {
    return record.crop != PixelWindow{0, record.width, 0, record.height};
}

std::any engine_options(const RenderRecord& record) {
    if (engines().find(record.engine).has_pool) return record.pool;
    return record.gpu;
}

bool loops_over_image(const RenderRecord& record) {
    return engines().find(record.engine).make(engine_options(record))->loops_over_image();
}

bool misses_target(const RenderRecord& record) {
    return record.target_error > 0 && record.adaptive.status != TargetStatus::Reached;
}

json settings_json(const RenderRecord& record) {
    const RenderSettings& settings = record.settings;
    json result{{"scene", record.scene_name},
                {"width", record.width},
                {"height", record.height},
                {"spp", record.spp},
                {"samples", {settings.first_sample, settings.end_sample}},
                {"depth", settings.depth},
                {"split_depth", settings.split_depth},
                {"seed", settings.seed},
                {"sampler", to_string(settings.sampler)},
                {"roulette", settings.roulette},
                {"light_sampling", to_string(settings.light_sampling)},
                {"precision", record.precision == Precision::Float ? "float" : "double"},
                {"engine", record.engine},
                {"threads", settings.threads},
                {"count_work", settings.count_work}};
    if (is_cropped(record)) {
        const PixelWindow& crop = record.crop;
        result["crop"] = {crop.x_begin, crop.y_begin, crop.x_end, crop.y_end};
    }
    if (loops_over_image(record)) {
        result["schedule"] = to_string(settings.schedule);
        if (has_grain(settings.schedule)) result["grain"] = to_string(settings.grain);
    }
    if (record.target_error > 0) result["target_error"] = record.target_error;
    if (record.has_aovs) result["aovs"] = true;
    if (engines().find(record.engine).has_pool) result["pool"] = to_json(record.pool);
    if (record.engine == "gpu") result["gpu"]["form"] = gpu::kFormNames[static_cast<std::size_t>(record.gpu.form)];
    if (record.engine == "gpu" && record.gpu.form == gpu::Form::Wave) result["gpu"]["rays"] = record.gpu.capacity;
    return result;
}

json stats_json(const RenderRecord& record) {
    const RenderReport& report = record.report;
    const wavefront::PoolReport& pool = wavefront::pool_report(report);
    const auto paths = static_cast<double>(report.paths());
    const auto segments = static_cast<double>(report.segments());
    const auto ratio = [](double a, double b) { return b == 0 ? json() : json(a / b); };  // of nothing there is none
    json threads = json::array();
    for (const ThreadReport& work : report.threads) {
        json thread{
            {"paths", work.paths}, {"segments", work.segments}, {"busy_s", work.busy_s}, {"wait_s", work.wait_s}};
        if (record.settings.count_work) {
            thread["box_tests"] = work.box_tests;
            thread["primitive_tests"] = work.primitive_tests;
        } else {
            thread["box_tests"] = nullptr;
            thread["primitive_tests"] = nullptr;
        }
        threads.push_back(thread);
    }
    json rounds = json::array();
    for (const wavefront::RoundReport& work : pool.rounds) {
        json round{{"records_in", work.records_in},
                   {"records_out", work.records_out},
                   {"lanes", work.lanes},
                   {"shadow_rays", work.shadow_rays},
                   {"shadow_hits", work.shadow_hits},
                   {"shadow_lanes", work.shadow_lanes},
                   {"wait_s", work.wait_s}};
        for (std::size_t i = 0; i < wavefront::kStageCount; ++i)
            round["stage_s"][wavefront::kStageNames[i]] = work.stage_s[i];
        rounds.push_back(round);
    }
    json lists = json::array();
    for (const wavefront::ListLevel& level : pool.lists) {
        if (level.lists == 0 || !record.ranks.empty()) break;  // the tree goes no deeper; one rank's are not all
        lists.push_back(
            {{"lists", level.lists}, {"rays", level.rays}, {"single_rays", level.single_rays}, {"lanes", level.lanes}});
    }
    json stats{
        {"hash", record.hash},
        {"seconds",
         {{"read", record.read_s},
          {"compile", record.compile_s},
          {"render", report.seconds},
          {"setup", report.setup_s},  // of render
          {"aovs", record.aovs_s},
          {"write", record.write_s},
          {"total", record.total_s}}},
        {"paths", report.paths()},
        {"segments", report.segments()},
        {"shadow_rays", report.total(&ThreadReport::shadow_rays)},
        {"samples_done", record.samples_done},
        {"segments_per_path", ratio(segments, paths)},
        {"mpaths_per_s", ratio(paths * 1e-6, report.seconds)},
        {"sample_statistics",
         {{"non_finite", report.statistics.non_finite},
          {"clamped", report.statistics.clamped},
          {"clamped_energy", report.statistics.clamped_energy}}},
        {"sums",
         {{"step", record.sum_step}, {"mean_radiance", record.mean_radiance}, {"dimmest_light", record.dimmest_light}}},
        {"truncation_bound", record.truncation_bound},
        {"features", feature_names(record.features)},
        {"settings", settings_json(record)},
        {"environment", environment_json()},
        {"threads", threads}};
    if (record.target_error > 0) {
        const auto [least, most] =
            std::minmax_element(record.adaptive.sample_counts.begin(), record.adaptive.sample_counts.end());
        stats["adaptive"] = {
            {"target", to_string(record.adaptive.status)},
            {"rmse_estimate", record.adaptive.rmse},
            {"reached", !misses_target(record)},
            {"rmse_most", record.adaptive.most_rmse},
            {"rmse_of_unseen_light", record.adaptive.unseen_rmse},
            {"pixels_without_variance", record.adaptive.flat_pixels},
            {"rounds", record.adaptive.rounds},
            {"samples_per_pixel", {{"least", *least}, {"mean", record.adaptive.mean_samples()}, {"most", *most}}}};
    }
    for (const RenderReport& rank : record.ranks) {
        double busy_s = 0;
        for (const ThreadReport& thread : rank.threads) busy_s += thread.busy_s;
        stats["ranks"].push_back({{"threads", rank.threads.size()},
                                  {"paths", rank.paths()},
                                  {"segments", rank.segments()},
                                  {"busy_s", busy_s}});
    }
    if (const gpu::GpuReport& device = gpu::gpu_report(report); !device.device.empty())
        stats["gpu"] = {{"device", device.device},
                        {"kernel_s", device.kernel_s},
                        {"rounds", device.rounds},
                        {"bytes", report.memory_bytes}};
    if (engines().find(record.engine).has_pool) {
        stats["record_bytes"] = pool.record_bytes;
        stats["pool_rays"] = pool.pool_rays;
        stats["pool_bytes"] = report.memory_bytes;
        stats["rounds"] = rounds;
        stats["lists"] = lists;
    }
    return stats;
}

}  // namespace raypool::cli
