// Where numerical methods break: the cases of bench/stability/, their error curves, verdicts, costs, and failed images.

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "bench/stability/case.h"
#include "bench/stability/failures.h"
#include "bench/studies/renders.h"
#include "bench/studies/studies.h"
#include "core/image/image_file.h"

namespace raypool::studies {

namespace {

using stability::Failure;
using stability::Kind;
using stability::Method;

constexpr const char* kCurve = "curve";
constexpr const char* kCost = "cost";
constexpr const char* kImage = "image";
constexpr std::int64_t kFailureDepth = 50;

const char* to_string(Kind kind) {
    switch (kind) {
        case Kind::Naive:
            return "naive";
        case Kind::Alternative:
            return "other";
        case Kind::Ours:
            break;
    }
    return "ours";
}

Row start_of_row(const char* kind, const std::string& id, const std::string& row, const Method& method) {
    return {kind, id, row, method.name, to_string(method.kind)};
}
void extend(Row& row, const Row& more) {
    row.insert(row.end(), more.begin(), more.end());
}

std::vector<Row> curve_rows(const stability::Case& one, std::int64_t samples) {
    std::vector<Row> rows;
    for (const Method& method : one.methods) {
        for (std::size_t i = 0; i < one.values.size(); ++i) {
            Row row = start_of_row(kCurve, one.id, one.row, method);
            extend(row, {one.parameter, one.values[i], one.measure, method.error(one.values[i], samples), one.tolerance,
                         i < one.held ? 1 : 0, nullptr});
            rows.push_back(std::move(row));
        }
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
std::vector<Row> cost_rows(const stability::Case& one) {
    std::vector<Row> rows;
    for (const Method& method : one.methods) {
        if (!method.work) continue;
        Row row = start_of_row(kCost, one.id, one.row, method);
        extend(row, {nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nanoseconds(method)});
        rows.push_back(std::move(row));
    }
    return rows;
}

RenderSettings failure_settings(const StudyOptions& options) {
    RenderSettings settings;
    settings.end_sample = choose(options.spp, options.is_quick, 16, 100);
    settings.depth = static_cast<std::int32_t>(choose(options.depth, false, 0, kFailureDepth));
    settings.seed = options.seed;
    settings.threads = static_cast<int>(choose(options.threads, false, 0, core_count()));
    settings.schedule = {LoopSchedule::Kind::Dynamic, 1};
    return settings;
}
Failure sized(Failure failure, const StudyOptions& options) {
    const std::int64_t width = choose(options.width, options.is_quick, 120, 240);
    failure.scene.height = std::max<std::int64_t>(1, failure.scene.height * width / failure.scene.width);
    failure.scene.width = width;
    return failure;
}

/// Both, against double: the part of the pixels that differ (as the error), a row each.
std::vector<Row> image_rows(const Failure& failure, const RenderSettings& settings) {
    const stability::FailureImages images = stability::render_failure(failure.variant, failure.scene, settings);
    std::vector<Row> rows;
    for (const bool is_ours : {false, true}) {
        const double changed = stability::changed_share(is_ours ? images.ours : images.naive, images.reference);
        rows.push_back({kImage, failure.id, failure.row, is_ours ? "ours, float" : "naive, float",
                        to_string(is_ours ? Kind::Ours : Kind::Naive), nullptr, nullptr, nullptr, changed, nullptr,
                        nullptr, nullptr});
    }
    return rows;
}

class Stability : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "stability"; }
    [[nodiscard]] std::string question() const override {
        return "Where do naive methods break, what does an image show of it, do ours hold there, and at what cost?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        return {
            {"kind", ColumnType::Text,
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
            {"ns", ColumnType::Real, "nanoseconds a call: of a ray, a sum's term, a number"}};
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        std::vector<Case> cases;
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 3, 7));
        for (const stability::Case& one : stability::all_cases()) {
            const std::int64_t samples = options.is_quick ? one.samples / 10 : one.samples;
            cases.push_back({"curve: " + one.id, "", 1, [&one, samples] { return curve_rows(one, samples); }});
            const bool is_timed =
                std::any_of(one.methods.begin(), one.methods.end(), [](const Method& m) { return bool(m.work); });
            if (is_timed) cases.push_back({"cost: " + one.id, "", repeats, [&one] { return cost_rows(one); }});
        }
        for (const Failure& failure : stability::all_failures()) {
            cases.push_back({"image: " + failure.id, "", 1,
                             [failure = sized(failure, options), settings = failure_settings(options)] {
                                 return image_rows(failure, settings);
                             }});
        }
        return cases;
    }

    void write_images(const std::filesystem::path& folder, const StudyOptions& options) const override {
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

    [[nodiscard]] nlohmann::json facts() const override {
        nlohmann::json cases = nlohmann::json::object();
        for (const stability::Case& one : stability::all_cases())
            cases[one.id] = {{"symptom", one.symptom}, {"limit", one.limit}};
        return {{"cases", cases}};
    }
};

}  // namespace

std::unique_ptr<Study> stability_study() {
    return std::make_unique<Stability>();
}

}  // namespace raypool::studies
