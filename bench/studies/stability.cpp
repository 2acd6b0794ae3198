// Where numerical methods break: the cases of bench/stability/, their error curves, verdicts, costs, and failed images.

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "bench/stability/case.h"
#include "bench/stability/failures.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "core/image/image_file.h"

namespace raypool::studies {

namespace {

using stability::Failure;
using stability::Method;
using MethodKind = stability::Kind;

constexpr const char* kCurve = "curve";
constexpr const char* kCost = "cost";
constexpr const char* kImage = "image";

const char* to_string(MethodKind kind) {
    constexpr const char* kNames[] = {"naive", "other", "ours"};
    return kNames[static_cast<std::size_t>(kind)];
}

Cells method_cells(const char* kind, const stability::Case& one, const Method& method) {
    return {{"kind", kind},
            {"id", one.id},
            {"row", one.row},
            {"method", method.name},
            {"method_kind", to_string(method.kind)}};
}

std::vector<Cells> curve_rows(const stability::Case& one, std::int64_t samples) {
    std::vector<Cells> rows;
    for (const Method& method : one.methods) {
        for (std::size_t i = 0; i < one.values.size(); ++i)
            rows.push_back(method_cells(kCurve, one, method) + Cells{{"parameter", one.parameter},
                                                                     {"value", one.values[i]},
                                                                     {"measure", one.measure},
                                                                     {"error", method.error(one.values[i], samples)},
                                                                     {"tolerance", one.tolerance},
                                                                     {"is_asked", i < one.held ? 1 : 0}});
    }
    return rows;
}

/// Nanoseconds a call, of so many that the clock does not matter. The result is kept where a compiler must not drop it.
double nanoseconds(const Method& method) {
    constexpr std::int64_t kCalls = 400'000;
    static volatile double kept = 0;
    const auto start = std::chrono::steady_clock::now();
    kept = kept + method.work(kCalls);
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / kCalls;
}
std::vector<Cells> cost_rows(const stability::Case& one) {
    std::vector<Cells> rows;
    for (const Method& method : one.methods)
        if (method.work) rows.push_back(method_cells(kCost, one, method) + Cells{{"ns", nanoseconds(method)}});
    return rows;
}

RenderSettings failure_settings(const StudyOptions& options) {
    const Plan plan = plan_of(options, {16, 100}, {1, 1}, core_count());
    RenderSettings settings = plan.settings;
    settings.threads = plan.most_threads;
    settings.schedule = {LoopSchedule::Kind::Dynamic, 1};
    return settings;
}
Failure sized(Failure failure, const StudyOptions& options) {
    const std::int64_t width = choose(options, options.width, {120, 240});
    failure.scene.height = std::max<std::int64_t>(1, failure.scene.height * width / failure.scene.width);
    failure.scene.width = width;
    return failure;
}

/// Both, against double: the part of the pixels that differ (as the error), a row each.
std::vector<Cells> image_rows(const Failure& failure, const RenderSettings& settings) {
    const stability::FailureImages images = stability::render_failure(failure.variant, failure.scene, settings);
    std::vector<Cells> rows;
    for (const bool is_ours : {false, true})
        rows.push_back({{"kind", kImage},
                        {"id", failure.id},
                        {"row", failure.row},
                        {"method", is_ours ? "ours, float" : "naive, float"},
                        {"method_kind", to_string(is_ours ? MethodKind::Ours : MethodKind::Naive)},
                        {"error", stability::changed_share(is_ours ? images.ours : images.naive, images.reference)}});
    return rows;
}

std::vector<Case> stability_study_cases(const StudyOptions& options) {
    std::vector<Case> cases;
    const int repeats = static_cast<int>(choose(options, options.repeats, {3, 7}));
    for (const stability::Case& one : stability::all_cases()) {
        const std::int64_t samples = options.is_quick ? one.samples / 10 : one.samples;
        cases.push_back({"curve: " + one.id, "", 1, [&one, samples] { return curve_rows(one, samples); }});
        const bool is_timed =
            std::any_of(one.methods.begin(), one.methods.end(), [](const Method& m) { return bool(m.work); });
        if (is_timed) cases.push_back({"cost: " + one.id, "", repeats, [&one] { return cost_rows(one); }});
    }
    for (const Failure& failure : stability::all_failures()) {
        cases.push_back(
            {"image: " + failure.id, "", 1, [failure = sized(failure, options), settings = failure_settings(options)] {
                 return image_rows(failure, settings);
             }});
    }
    return cases;
}

void write_failures(const std::filesystem::path& folder, const StudyOptions& options) {
    for (const Failure& failure : stability::all_failures()) {
        const stability::FailureImages images =
            stability::render_failure(failure.variant, sized(failure, options).scene, failure_settings(options));
        Image difference = images.naive;
        for (std::size_t i = 0; i < difference.rgb.size(); ++i)
            difference.rgb[i] = std::fabs(images.naive.rgb[i] - images.reference.rgb[i]);
        write_image(folder / (failure.id + "_naive.png"), images.naive, {});
        write_image(folder / (failure.id + "_ours.png"), images.ours, {});
        write_image(folder / (failure.id + "_difference.png"), difference, {});
    }
}

nlohmann::json stability_facts() {
    nlohmann::json cases = nlohmann::json::object();
    for (const stability::Case& one : stability::all_cases())
        cases[one.id] = {{"symptom", one.symptom}, {"limit", one.limit}};
    return {{"cases", cases}};
}

}  // namespace

Study stability_study() {
    return {
        .name = "stability",
        .question =
            "Where do naive methods break, what does an image show of it, do ours hold there, and at what "
            "cost?",
        .columns =
            {{"kind", ColumnType::Text,
              "curve (an error at a value), cost (nanoseconds a call), or image (part of the pixels that differ from "
              "a render in double)"},
             {"id", ColumnType::Text, "of the case in bench/stability/, or of the failed image"},
             {"row", ColumnType::Text, "of the table in docs/stability.md"},
             {"method", ColumnType::Text, "and its precision"},
             {"method_kind", ColumnType::Text, "naive, ours, or other"},
             {"parameter", ColumnType::Text, "what is made harder"},
             {"value", ColumnType::Signed, "of the parameter"},
             {"measure", ColumnType::Text, "what the error is"},
             {"error", ColumnType::Real, "by the measure"},
             {"tolerance", ColumnType::Real, "an error above it is a failure"},
             {"is_asked", ColumnType::Count, "1: ours must hold the tolerance at this value"},
             {"ns", ColumnType::Real, "nanoseconds a call: of a ray, a sum's term, a number"}},
        .cases = stability_study_cases,
        .facts = stability_facts,
        .write_images = write_failures};
}

}  // namespace raypool::studies
