// What the runs of the study of speed and accuracy say.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/accuracy/statistics.h"
#include "bench/studies/speed_accuracy.h"
#include "bench/studies/statistics.h"

namespace raypool::studies::speed_accuracy {

namespace {

using accuracy::mean;

using accuracy::Comparison;
using accuracy::Configuration;
using accuracy::Runs;
using accuracy::Winner;

constexpr std::uint64_t kBootstrapSeed = 1;

/// Rows of one scene.
struct Scene {
    std::string name;
    Table bias, runs;

    [[nodiscard]] std::vector<double> spps() const {
        std::vector<double> spps;
        for (const Value& spp : runs.distinct("spp")) spps.push_back(spp.get<double>());
        std::sort(spps.begin(), spps.end());
        return spps;
    }
    [[nodiscard]] bool has(const Configuration& c) const {
        return !runs.where("configuration", to_string(c)).is_empty();
    }
    /// In the order of their seeds, which is that of the rows of any one configuration.
    [[nodiscard]] Runs at(const std::string& configuration, double spp) const {
        const Table rows = runs.where("configuration", configuration).where("spp", static_cast<std::int64_t>(spp));
        return {rows.numbers("seconds"), rows.numbers("mse")};
    }
};

/// Of mean squared errors; zero where the correction for noise left nothing.
double rmse(const Runs& runs) {
    return std::sqrt(std::max(mean(runs.mse), 0.0));
}

std::string ratio_text(const Comparison& c) {
    return std::isfinite(c.ratio) && std::isfinite(c.interval.high)
               ? fmt::format("{:.2f} ({:.2f} to {:.2f})", c.ratio, c.interval.low, c.interval.high)
               : "too near the reference to tell";
}

std::string slope_text(const std::vector<double>& spps, const std::vector<double>& errors) {
    std::vector<double> x;
    std::vector<double> y;
    for (std::size_t i = 0; i < spps.size(); ++i) {
        if (errors[i] <= 0) continue;
        x.push_back(spps[i]);
        y.push_back(errors[i]);
    }
    return x.size() < 2 ? "" : fmt::format("{:.2f}", accuracy::log_log_slope(x, y));
}

/// The bias as an error: "3.1e-02", or "< 2e-05" where it does not stand out of its noise.
std::string bias_text(const Table& row) {
    if (row.is_empty()) return "";
    const double squared = row.numbers("bias_squared").front();
    const double error = row.numbers("bias_error").front();
    if (squared == 0 && error == 0) return "0";  // the trusted images, bit by bit
    return squared > 2 * error ? fmt::format("{:.1e}", std::sqrt(squared))
                               : fmt::format("< {:.1e}", std::sqrt(std::max(squared, 0.0) + 2 * error));
}

/// The bias belongs to the image, which the engine does not change.
const std::string& image_name(const Configuration& c, std::string& text) {
    Configuration any_engine = c;
    any_engine.engine = accuracy::EngineKind::Pool;
    return text = to_string(any_engine);
}

TextTable overview(const Scene& scene, const StudyOptions& options) {
    const std::vector<double> spps = scene.spps();
    const double most = spps.back();
    TextTable table{fmt::format("{}: at {:g} samples a pixel, held against {}", scene.name, most,
                                to_string(base_configuration(options.depth))),
                    {"configuration", "RMSE", "ms", "slope of the RMSE", "bias (RMSE)", "efficiency", "verdict"},
                    {}};
    const Runs base = scene.at(to_string(base_configuration(options.depth)), most);
    std::string name;
    for (const Configuration& c : configurations(options.depth, true)) {
        if (!scene.has(c)) continue;
        std::vector<double> errors;
        for (const double spp : spps) errors.push_back(rmse(scene.at(to_string(c), spp)));
        const Runs runs = scene.at(to_string(c), most);
        const Comparison found = compare_efficiency(runs, base, kBootstrapSeed);
        const bool is_base = c == base_configuration(options.depth);
        const char* verdict = is_base                                   ? ""
                              : found.winner == Winner::First           ? "better"
                              : found.winner == Winner::Second          ? "worse"
                              : runs.mse.size() < accuracy::kLeastSeeds ? "too few seeds"
                                                                        : "no difference";
        table.rows.push_back({to_string(c), fmt::format("{:.3e}", rmse(runs)),
                              fmt::format("{:.3g}", 1e3 * median(runs.seconds)), slope_text(spps, errors),
                              bias_text(scene.bias.where("configuration", image_name(c, name))),
                              is_base ? "1" : ratio_text(found), verdict});
    }
    return table;
}

/// What one thing changes: who is held against whom.
struct Question {
    std::string claim;
    Configuration first, second;
};

std::vector<Question> questions(std::int64_t depth) {
    const Configuration base = base_configuration(depth);
    const auto changed = [&](auto change) {
        Configuration c = base;
        change(c);
        return c;
    };
    std::vector<Question> all;
    all.push_back(
        {"the pool reaches the error of recursion in less time (the images are the same, so the ratio is that "
         "of the times)",
         base, changed([](Configuration& c) { c.engine = accuracy::EngineKind::Recursive; })});
    all.push_back({"float reaches the error of double in less time", base,
                   changed([](Configuration& c) { c.precision = accuracy::Precision::Double; })});
    all.push_back({"Sobol points reach the error of independent ones in less time",
                   changed([](Configuration& c) { c.sampler = Sampler::Sobol; }), base});
    all.push_back({"Russian roulette reaches the error of whole paths in less time",
                   changed([](Configuration& c) { c.roulette = true; }), base});
    all.push_back({"a depth of 5 reaches less error in the time of the whole depth",
                   changed([](Configuration& c) { c.depth = 5; }), base});
    all.push_back({"to follow both branches of the first hit on glass reaches an error in less time",
                   changed([](Configuration& c) { c.split_depth = 1; }), base});
    return all;
}

TextTable by_samples(const Scene& scene, const StudyOptions& options) {
    TextTable table{fmt::format("{}: efficiency by samples a pixel", scene.name), {"first, over second"}, {}};
    for (const double spp : scene.spps()) table.header.push_back(fmt::format("{:g}", spp));
    for (const Question& q : questions(options.depth)) {
        if (!scene.has(q.first) || !scene.has(q.second)) continue;
        std::vector<std::string> line{fmt::format("{} / {}", to_string(q.first), to_string(q.second))};
        for (const double spp : scene.spps())
            line.push_back(ratio_text(compare_efficiency(scene.at(to_string(q.first), spp),
                                                         scene.at(to_string(q.second), spp), kBootstrapSeed)));
        table.rows.push_back(std::move(line));
    }
    return table;
}

/// One answer over all scenes: it holds where the first wins everywhere.
std::optional<Finding> answer(const Question& question, const std::vector<Scene>& scenes) {
    std::vector<std::string> parts;
    std::size_t first = 0;
    std::size_t second = 0;
    std::size_t seeds = 0;
    double spp = 0;
    for (const Scene& scene : scenes) {
        if (!scene.has(question.first) || !scene.has(question.second)) continue;
        const Runs runs = scene.at(to_string(question.first), scene.spps().back());
        const Comparison found =
            compare_efficiency(runs, scene.at(to_string(question.second), scene.spps().back()), kBootstrapSeed);
        first += found.winner == Winner::First ? 1 : 0;
        second += found.winner == Winner::Second ? 1 : 0;
        seeds = runs.mse.size();
        spp = scene.spps().back();
        parts.push_back(fmt::format("{} {}{}", scene.name, ratio_text(found),
                                    found.winner == Winner::NoDifference ? ", no difference" : ""));
    }
    if (parts.empty()) return {};
    Finding finding{"",
                    fmt::format("at {:g} samples a pixel {}", spp, question.claim),
                    "",
                    fmt::format("{}", fmt::join(parts, "; ")),
                    Verdict::CannotTell,
                    ""};
    if (seeds < accuracy::kLeastSeeds) {
        finding.why = fmt::format("fewer than {} seeds", accuracy::kLeastSeeds);
    } else if (first == parts.size()) {
        finding.verdict = Verdict::Holds;
    } else if (second == parts.size()) {
        finding.verdict = Verdict::DoesNotHold;
    } else {
        finding.why = first + second == 0 ? "no difference" : "it depends on the scene";
    }
    return finding;
}

/// That float has no bias that an image would show.
Finding float_bias(const std::vector<Scene>& scenes, const StudyOptions& options) {
    std::vector<std::string> parts;
    bool is_small = true;
    const std::string base = to_string(base_configuration(options.depth));
    for (const Scene& scene : scenes) {
        const Table row = scene.bias.where("configuration", base);
        const double error = rmse(scene.at(base, scene.spps().back()));
        const double most = row.numbers("bias_squared").front() + 2 * row.numbers("bias_error").front();
        is_small = is_small && std::sqrt(std::max(most, 0.0)) < 0.1 * error;
        parts.push_back(fmt::format("{} {} (error {:.1e})", scene.name, bias_text(row), error));
    }
    return {"",
            fmt::format("the bias of {} is below a tenth of its error at the most samples", base),
            "",
            fmt::format("{}", fmt::join(parts, "; ")),
            is_small ? Verdict::Holds : Verdict::DoesNotHold,
            ""};
}

}  // namespace

Summary summarise(const Table& data, const StudyOptions& options) {
    std::vector<Scene> scenes;
    for (const Value& name : data.distinct("scene"))
        scenes.push_back({name.get<std::string>(), data.where("scene", name).where("kind", kBias),
                          data.where("scene", name).where("kind", kRun)});
    Summary summary;
    for (const Question& question : questions(options.depth))
        if (const auto finding = answer(question, scenes)) summary.findings.push_back(*finding);
    summary.findings.push_back(float_bias(scenes, options));
    for (const Scene& scene : scenes) {
        summary.tables.push_back(overview(scene, options));
        summary.tables.push_back(by_samples(scene, options));
    }
    summary.pictures.push_back(
        {"speed_accuracy", "Error against time",
         "Root mean square error of linear radiance against the time of a render, both on logarithmic scales; a line "
         "for each configuration, a point for each count of samples (mean of the squared errors, median of the times, "
         "over the seeds). Grey: the slope of chance, -1/2. Dashed: the bias, an error that more samples do not mend. "
         "Ringed: the Pareto front, points that no other beats in both. What to see: a line further to the left "
         "reaches the same error sooner; a line that bends onto its dashed floor never reaches what lies below."});
    summary.notes.push_back(
        "Errors are held against the mean of two independent halves, double, deep, with 32 times the greatest count of "
        "samples each; the noise that the reference itself has is taken off.");
    summary.notes.push_back(fmt::format(
        "Efficiency is 1 / (mean squared error x seconds). Ratios are of runs with the same seeds, side by side, with "
        "the 95 % interval of a bootstrap over the seeds; somebody wins only where it excludes 1 and there are at "
        "least "
        "{} seeds.",
        accuracy::kLeastSeeds));
    return summary;
}

}  // namespace raypool::studies::speed_accuracy
