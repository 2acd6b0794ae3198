// Adaptive sampling against the same number of samples everywhere: error, time, bias, and how threads share the work.

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "bench/accuracy/reference.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/runner.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/runtime/adaptive.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"
#include "recursive/engine.h"
#include "wavefront/engine.h"

namespace raypool::studies {

namespace {

using accuracy::mean;

using SharedScene = std::shared_ptr<const accuracy::SceneInBoth>;
using SharedReference = std::shared_ptr<accuracy::Reference>;

/// No pixel gets more.
constexpr std::int64_t kMostSamples = 1 << 16;
constexpr int kThreads = 1;  ///< of what is timed

/// A scene, and the errors that are asked for: those of about 32 and of about 128 samples a pixel.
struct Target {
    const char* scene;
    std::vector<double> errors;
};
const std::vector<Target> kTargets{{"half_sky", {0.008, 0.004}},
                                   {"paper", {0.03, 0.015}},
                                   {"cornell", {0.15, 0.075}},
                                   {"glass_stack", {0.025, 0.0125}}};

struct AdaptivePlan {
    std::int64_t width;
    std::int64_t half_spp;
    int seeds;
    std::uint64_t first_seed;
    int load_threads;
};

AdaptivePlan adaptive_plan(const StudyOptions& options) {
    return {choose(options, options.width, {96, 240}), 32 * choose(options, options.spp, {64, 256}),
            static_cast<int>(choose(options, options.repeats, {5, 12})), options.seed,
            options.threads != 0 ? options.threads : 8};
}

/// What a render took and made.
struct Made {
    accuracy::TimedImage image;
    AdaptiveReport adaptive;
};

RenderSettings settings_of(std::uint64_t seed, int threads) {
    RenderSettings settings;
    settings.seed = seed;
    settings.threads = threads;
    return settings;
}

Made make_adaptive(const Engine& engine, const CompiledScene<float>& scene, RenderSettings settings, double error) {
    settings.end_sample = kMostSamples;
    Framebuffer framebuffer(scene.width, scene.height, fixed_point(scene, settings, kMostSamples), Halves::Apart);
    Made made;
    made.image.report = render_adaptively(engine, scene, settings, error, framebuffer, made.adaptive);
    made.image.hash = framebuffer.hash();
    const double scale = 1 / framebuffer.fixed_point().scale();
    for (std::size_t pixel = 0; pixel < made.adaptive.sample_counts.size(); ++pixel)
        for (const std::int64_t sum : framebuffer.sum(pixel))
            made.image.values.push_back(static_cast<double>(sum) * scale / made.adaptive.sample_counts[pixel]);
    return made;
}

/// An engine that keeps what threads did in each unit of its renders.
class PassLog : public Engine {
  public:
    explicit PassLog(const Engine& engine) : engine_(engine) {}
    [[nodiscard]] std::string name() const override { return engine_.name(); }
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>& scene,
                                                       const RenderSettings& settings,
                                                       Framebuffer& framebuffer) const override {
        return std::make_unique<Session>(passes_, engine_.begin(scene, settings, framebuffer));
    }
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>& scene,
                                                       const RenderSettings& settings,
                                                       Framebuffer& framebuffer) const override {
        return std::make_unique<Session>(passes_, engine_.begin(scene, settings, framebuffer));
    }

    /// Segments that passes take when their slowest threads are waited for, over the segments that there are for a
    /// thread: 1 is perfect balance.
    [[nodiscard]] double load() const {
        double longest = 0, fair = 0;
        for (const RenderReport& pass : passes_) {
            std::int64_t most = 0;
            for (const ThreadReport& thread : pass.threads) most = std::max(most, thread.segments);
            longest += static_cast<double>(most);
            fair += static_cast<double>(pass.segments()) / static_cast<double>(pass.threads.size());
        }
        return longest / fair;
    }

  private:
    class Session : public RenderSession {
      public:
        Session(std::vector<RenderReport>& passes, std::unique_ptr<RenderSession> session)
            : passes_(passes), session_(std::move(session)) {
            report_ = session_->report();
        }

      private:
        RenderReport render(const RenderUnit& unit) override { return passes_.emplace_back(session_->add(unit)); }
        RenderReport collect() override { return session_->merge(); }

        std::vector<RenderReport>& passes_;
        std::unique_ptr<RenderSession> session_;
    };

    const Engine& engine_;
    mutable std::vector<RenderReport> passes_;
};

/// Ways to share out the pixels of a pass. Static ones fix beforehand what each thread does, so that they can be
/// counted with any number of threads; pools whose threads take lines as they ask for them run on the cores that there
/// are.
struct Sharing {
    LoopWay way;
    bool is_pool;
};
constexpr Sharing kSharings[] = {{{"lines, static", "line", "static"}, false},
                                 {{"lines, static,1", "line", "static,1"}, false},
                                 {{"pixels, static,1", "pixel", "static,1"}, false},
                                 {{"pools, lines as asked for", "line", "dynamic"}, true}};

/// Adaptive, and then uniform with as many paths, one after the other.
Case pair_case(const SharedScene& scene, const SharedReference& reference, const AdaptivePlan& plan, double error,
               std::uint64_t seed) {
    const auto run = [=]() -> std::vector<Cells> {
        const wavefront::WavefrontEngine pool({});
        const double begin = wall_seconds();
        const Made adaptive = make_adaptive(pool, scene->in_float, settings_of(seed, kThreads), error);
        const double adaptive_s = wall_seconds() - begin;

        const auto spp = std::max<std::int64_t>(1, std::llround(adaptive.adaptive.mean_samples()));
        const accuracy::TimedImage same = render_image({}, *scene, {0, spp, seed, kThreads});
        const accuracy::Halves& halves = reference->halves();
        const double truth = mean(mean_of(halves));
        const auto row = [&](const char* method, double samples, double seconds, const accuracy::TimedImage& image) {
            return Cells{{"kind", "run"},
                         {"scene", scene->description.name},
                         {"target", error},
                         {"method", method},
                         {"width", plan.width},
                         {"threads", kThreads},
                         {"seed", seed},
                         {"samples", samples},
                         {"seconds", seconds},
                         {"segments", image.report.segments()},
                         {"mse", corrected_mse(image.values, halves)},
                         {"shift", mean(image.values) / truth - 1},
                         {"hash", image.hash}};
        };
        const AdaptiveReport& report = adaptive.adaptive;
        return {row("adaptive", report.mean_samples(), adaptive_s, adaptive.image) +
                    Cells{{"rounds", report.rounds}, {"rmse_estimate", report.rmse}},
                row("uniform", static_cast<double>(spp), same.report.seconds, same)};
    };
    return {fmt::format("{} to {:g}, seed {}", scene->description.name, error, seed), "", 1, run};
}

/// How much each thread does in the passes of an adaptive render and in a uniform one.
std::vector<Cells> load_rows(const accuracy::SceneInBoth& scene, const AdaptivePlan& plan, double error) {
    std::vector<Cells> rows;
    std::string expected;
    const recursive::IterativeEngine loop;
    const wavefront::WavefrontEngine pool({});
    for (const Sharing& sharing : kSharings) {
        const int threads = sharing.is_pool ? std::min(plan.load_threads, core_count()) : plan.load_threads;
        const Engine& engine = sharing.is_pool ? static_cast<const Engine&>(pool) : loop;
        RenderSettings settings = with_way(settings_of(plan.first_seed, threads), sharing.way);

        const PassLog adaptive(engine);
        const Made made = make_adaptive(adaptive, scene.in_float, settings, error);
        if (!expected.empty() && made.image.hash != expected)
            throw WrongImage(std::string(sharing.way.name) + ": another image than the first sharing made");
        expected = made.image.hash;

        const PassLog uniform(engine);
        settings.end_sample = std::max<std::int64_t>(1, std::llround(made.adaptive.mean_samples()));
        Framebuffer framebuffer(scene.in_float.width, scene.in_float.height,
                                FixedPoint::make(settings.end_sample, scene.in_float.max_radiance));
        static_cast<void>(uniform.render(scene.in_float, settings, framebuffer));
        for (const auto& [method, log] : {std::pair{"adaptive", &adaptive}, {"uniform", &uniform}})
            rows.push_back({{"kind", "load"},
                            {"scene", scene.description.name},
                            {"target", error},
                            {"method", method},
                            {"sharing", sharing.way.name},
                            {"width", plan.width},
                            {"threads", threads},
                            {"seed", plan.first_seed},
                            {"load", log->load()}});
    }
    return rows;
}

std::vector<Case> adaptive_cases(const StudyOptions& options) {
    const AdaptivePlan plan = adaptive_plan(options);
    const std::filesystem::path folder = options.folder.empty() ? "" : options.folder / "references";
    std::vector<Case> cases;
    std::vector<std::function<Case(std::uint64_t)>> by_seed;
    for (const Target& target : kTargets) {
        if (options.is_scene_given && options.scene != target.scene) continue;
        Scene description = load_scene(target.scene);
        set_width(description, plan.width);
        const auto scene = std::make_shared<const accuracy::SceneInBoth>(description);
        const auto reference = std::make_shared<accuracy::Reference>(scene, plan.half_spp, folder, core_count());
        for (int part = 0; part < 2; ++part)
            cases.push_back({fmt::format("reference: {}, half {}", target.scene, part), "", 1, [=] {
                                 reference->extend(plan.half_spp);
                                 const Cells row{{"kind", "reference"}, {"scene", target.scene}, {"width", plan.width}};
                                 return std::vector<Cells>{row};
                             }});
        for (const double error : target.errors)
            by_seed.emplace_back([=](std::uint64_t seed) { return pair_case(scene, reference, plan, error, seed); });
        cases.push_back({"load: " + scene->description.name, "", 1,
                         [=, error = target.errors[0]] { return load_rows(*scene, plan, error); }});
    }
    if (cases.empty())
        throw InputError("--scene: the study knows errors to ask for of half_sky, paper, cornell and glass_stack");
    for (int turn = 0; turn < plan.seeds; ++turn)
        for (const auto& make : by_seed) cases.push_back(make(plan.first_seed + static_cast<std::uint64_t>(turn)));
    return cases;
}

}  // namespace

Study adaptive_study() {
    return {.name = "adaptive",
            .question =
                "When does it pay to give noisy pixels more samples, what bias does it cost, and what does it do "
                "to static schedules?",
            .columns = {{"kind", ColumnType::Text, "reference (being made), run, or load"},
                        {"scene", ColumnType::Text, "what was rendered"},
                        {"target", ColumnType::Real, "RMSE asked for, linear radiance"},
                        {"method", ColumnType::Text, "adaptive, or uniform with as many paths"},
                        {"sharing", ColumnType::Text, "of a load: how pixels were shared out"},
                        {"width", ColumnType::Count, "image width, pixels"},
                        {"threads", ColumnType::Count, "OpenMP threads"},
                        {"seed", ColumnType::Count, "of all random numbers"},
                        {"rounds", ColumnType::Count, "of estimating and rendering"},
                        {"samples", ColumnType::Real, "for each pixel, on average"},
                        {"seconds", ColumnType::Real,
                         "wall clock of the render: setup, loops, last passes; and of the estimates between them"},
                        {"segments", ColumnType::Count, "rays traced"},
                        {"rmse_estimate", ColumnType::Real, "what the render itself takes its error for"},
                        {"mse", ColumnType::Signed, "squared error against the reference, less the reference's noise"},
                        {"shift", ColumnType::Signed, "mean of the image over that of the reference, less 1"},
                        {"load", ColumnType::Real, "segments of the busiest threads of all passes over fair shares"},
                        {"hash", ColumnType::Text, "of the sums"}},
            .cases = adaptive_cases};
}

}  // namespace raypool::studies
