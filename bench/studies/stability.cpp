// Where numerical methods break: the cases of bench/stability/, their error curves, verdicts, costs, and failed images.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "bench/stability/case.h"
#include "bench/stability/failures.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
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
                         i < one.held_values() ? 1 : 0, nullptr});
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

std::string number(double x) {
    return x == 0 ? "0" : fmt::format("{:.2g}", x);
}

/// Where a method breaks, first and worst, in words.
struct Breaking {
    bool is_broken = false;
    bool is_within_held = false;  ///< broken where ours must hold
    std::string text = "holds";
};
Breaking breaking(const stability::Case& one, const Table& rows) {
    Breaking breaking;
    double worst = 0;
    const std::vector<double> errors = rows.numbers("error");
    for (const double error : errors) worst = std::max(worst, error);
    for (std::size_t i = 0; i < std::min(errors.size(), one.values.size()); ++i) {
        if (errors[i] <= one.tolerance) continue;
        breaking.is_broken = true;
        breaking.is_within_held = i < one.held_values();
        breaking.text =
            fmt::format("breaks at {:g} with {}; worst {}", one.values[i], number(errors[i]), number(worst));
        break;
    }
    if (!breaking.is_broken) breaking.text = fmt::format("holds; worst {}", number(worst));
    return breaking;
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

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions& options) const override;
};

TextTable verdict_table(const Table& curves) {
    TextTable table{"Where each method breaks",
                    {"row", "case", "parameter", "measure", "tolerance", "method", "verdict", "in an image"},
                    {}};
    for (const stability::Case& one : stability::all_cases()) {
        bool is_first = true;
        for (const Method& method : one.methods) {
            const Breaking found = breaking(one, curves.where("id", one.id).where("method", method.name));
            std::string verdict = found.text;
            if (method.kind == Kind::Ours && found.is_broken && !found.is_within_held && !one.limit.empty())
                verdict += " (" + one.limit + ")";
            const auto once = [&](const std::string& text) { return is_first ? text : std::string(); };
            table.rows.push_back({once(one.row), once(one.id), once(one.parameter), once(one.measure),
                                  once(number(one.tolerance)),
                                  method.kind == Kind::Ours ? "**" + method.name + "**" : method.name, verdict,
                                  method.kind == Kind::Naive && found.is_broken ? one.symptom : ""});
            is_first = false;
        }
    }
    return table;
}

TextTable cost_table(const Table& costs) {
    TextTable table{"What robustness costs, nanoseconds a call (median, lowest and highest run)",
                    {"row", "case", "method", "ns"},
                    {}};
    for (const Value& id : costs.distinct("id"))
        for (const Value& method : costs.where("id", id).distinct("method")) {
            const Table runs = costs.where("id", id).where("method", method);
            table.rows.push_back({runs.distinct("row").at(0).get<std::string>(), id.get<std::string>(),
                                  method.get<std::string>(), to_text(spread(runs.numbers("ns")))});
        }
    return table;
}

Summary Stability::summarise(const Table& data, const StudyOptions&) const {
    Summary summary;
    const Table curves = data.where("kind", kCurve);

    // All naive methods break, and ours hold where they are said to.
    std::string held_not;
    std::string broken_not;
    std::size_t ours = 0;
    std::size_t naive = 0;
    for (const stability::Case& one : stability::all_cases()) {
        for (const Method& method : one.methods) {
            const Breaking found = breaking(one, curves.where("id", one.id).where("method", method.name));
            const std::string name = fmt::format("{} ({})", one.id, method.name);
            if (method.kind == Kind::Ours) {
                ++ours;
                if (found.is_within_held) held_not += (held_not.empty() ? "" : ", ") + name;
            } else if (method.kind == Kind::Naive) {
                ++naive;
                if (!found.is_broken) broken_not += (broken_not.empty() ? "" : ", ") + name;
            }
        }
    }
    summary.findings.push_back({"", "ours hold the tolerance wherever the case asks it", "",
                                fmt::format("{} methods in {} cases", ours, stability::all_cases().size()),
                                held_not.empty() ? Verdict::Holds : Verdict::DoesNotHold, held_not});
    summary.findings.push_back({"", "every naive method breaks within its case", "", fmt::format("{} methods", naive),
                                broken_not.empty() ? Verdict::Holds : Verdict::DoesNotHold, broken_not});
    const Table images = data.where("kind", kImage);
    for (const Failure& failure : stability::all_failures()) {
        const Table both = images.where("id", failure.id);
        const double naive_changed = both.where("method_kind", "naive").numbers("error").at(0);
        const double our_changed = both.where("method_kind", "ours").numbers("error").at(0);
        summary.findings.push_back(
            {"", fmt::format("{}: the naive method changes more of the image than single precision does", failure.id),
             "",
             fmt::format("pixels that differ from double by more than 0.02: naive {:.1f} %, ours {:.1f} %",
                         100 * naive_changed, 100 * our_changed),
             naive_changed > our_changed ? Verdict::Holds : Verdict::DoesNotHold, ""});
    }
    summary.tables.push_back(verdict_table(curves));
    summary.tables.push_back(cost_table(data.where("kind", kCost)));

    for (const Failure& failure : stability::all_failures())
        summary.pictures.push_back({failure.id, failure.title, failure.caption});
    const char* how =
        " Dashed: naive; solid: ours; dotted: others. The grey line is the tolerance, the shaded part lies beyond what "
        "is asked of ours. An error of 0 lies on the lower edge.";
    const auto add = [&](const char* name, const char* title, const char* what) {
        summary.pictures.push_back({name, title, std::string(what) + how});
    };
    add("spheres", "Far, grazing and huge spheres", "What to see: naive curves climb by the square of the distance.");
    add("leaving", "Rays that start on a surface",
        "What to see: any least distance is too small here and too large there.");
    add("boxes", "Boxes and motion", "What to see: naive tests are wrong from the first value on.");
    add("scattering", "Directions and glass", "What to see: not-a-numbers where arithmetic meets its edge.");
    add("paths", "Long paths and sums", "What to see: sums in float stop growing, and depend on their order.");
    add("others", "Seeds, checkers, sizes, flat shapes", "What to see: ours holds far out, and where it ends.");
    summary.notes.push_back(
        "Errors come from fixed seeds and are the same in every run on one machine. Costs are timed in a register of "
        "rays (spheres, checkers), one by one (boxes, glass), or a term or number at a time, all in the first-level "
        "cache.");
    summary.notes.push_back(
        "The images of failure are made by the iterative engine, its kernels compiled with one naive method "
        "(bench/stability/naive_engines.cpp); the same samples everywhere, so differences are not noise.");
    return summary;
}

}  // namespace

std::unique_ptr<Study> stability_study() {
    return std::make_unique<Stability>();
}

}  // namespace raypool::studies
