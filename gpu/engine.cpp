#include "gpu/engine.h"

#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/memory.h"
#include "gpu/device_scene.h"

namespace raypool::gpu {

namespace {

/// Columns of the pools of Form::Wave.
struct Columns {
    std::size_t record;
    std::size_t hit;
    std::size_t shadow_ray;  ///< 0 where lights are not sampled

    template <Features features>
    static constexpr Columns of() {
        return {column_count<features, RayRecord<float>>(), column_count<features, Hit<float>>(),
                features.lights ? column_count<features, ShadowRay>() : 0};
    }
    [[nodiscard]] std::size_t bytes(std::size_t capacity) const {
        return (2 * record + hit + shadow_ray) * capacity * sizeof(std::uint32_t);
    }
};

Columns columns_of(std::size_t features) {
    return dispatch_features<kFirstFeatures>(kCompiledFeatures[kFirstFeatures + features],
                                             []<Features compiled>() { return Columns::of<compiled>(); });
}

/// Of the pixels of a unit: at most all of them.
std::size_t pixel_list_bytes(const SceneView<float>& scene) {
    return static_cast<std::size_t>(scene.pixel_count()) * sizeof(std::uint32_t);
}

class GpuSession : public RenderSession {
  public:
    GpuSession(const CompiledScene<float>& scene, const RenderSettings& settings, Framebuffer& framebuffer,
               const GpuSettings& gpu, const DeviceMaker& device)
        : begin_s_(wall_seconds()),
          settings_(settings),
          framebuffer_(framebuffer),
          form_(gpu.form),
          device_(device(settings.threads)) {
        const Features needed = needed_features(scene.features, settings);
        features_ = compiled_features_index(needed, kFirstFeatures) - kFirstFeatures;
        const Columns columns = columns_of(features_);
        const auto capacity = static_cast<std::size_t>(form_ == Form::Wave ? gpu.capacity : 0);

        report_.memory_bytes = DeviceScene::bytes(scene) + framebuffer.sums().size_bytes() + columns.bytes(capacity) +
                               pixel_list_bytes(scene);
        device_->make_ready(kernels(), features_);  // which takes memory of its own
        const std::size_t free = device_->free_bytes();
        if (report_.memory_bytes > free)
            throw InputError(
                fmt::format("--engine gpu, --pool-rays: the scene, the sums and the pool take {}, of {} of "
                            "the memory of {} that are free",
                            bytes_text(report_.memory_bytes), bytes_text(free), device_->name()));
        scene_ = std::make_unique<DeviceScene>(*device_, scene);
        sums_ = DeviceArray<std::int64_t>(*device_, framebuffer.sums().size());
        clear_sums();
        counters_ = DeviceArray<Counters>(*device_, 1);
        for (auto& pool : records_) pool = DeviceArray<std::uint32_t>(*device_, columns.record * capacity);
        hits_ = DeviceArray<std::uint32_t>(*device_, columns.hit * capacity);
        shadow_rays_ = DeviceArray<std::uint32_t>(*device_, columns.shadow_ray * capacity);

        launch_.scene = scene_->view();
        launch_.seed = random_seed(settings.seed, settings.sampler);
        launch_.depth = settings.depth;
        launch_.roulette = settings.roulette;
        launch_.light_sampling = needed_light_sampling(scene.features, settings);
        launch_.converter = SampleConverter(framebuffer.fixed_point());
        launch_.has_halves = framebuffer.has_halves();
        launch_.sums = sums_.data();
        launch_.counters = counters_.data();
        launch_.wave = {static_cast<std::uint32_t>(capacity),
                        {records_[0].data(), records_[1].data()},
                        hits_.data(),
                        shadow_rays_.data()};

        const auto own = std::make_shared<GpuReport>();
        own->device = device_->name();
        own->capacity = static_cast<std::int64_t>(capacity);
        report_.engine = own;
        report_.threads.resize(1);
        report_.seconds = report_.setup_s = wall_seconds() - begin_s_;
    }

  private:
    RenderReport render(const RenderUnit& unit) override {
        const std::int64_t paths = path_count(launch_.scene, unit);
        if (paths == 0) return {};
        const double begin = wall_seconds();
        if (unit.pixels != nullptr) pixels_ = DeviceArray<std::uint32_t>(*device_, *unit.pixels);
        launch_.first_sample = unit.first_sample;
        launch_.pixels = unit.pixels == nullptr ? nullptr : pixels_.data();
        launch_.pixel_count =
            unit.pixels == nullptr ? launch_.scene.pixel_count() : static_cast<std::int64_t>(unit.pixels->size());
        launch_.path_count = settings_.depth == 0 ? 0 : paths;
        counters_.copy_in(std::array{Counters{}});

        switch (form_) {
            case Form::Mega:
                device_->launch(Kernel::Mega, features_, launch_, launch_.path_count);
                break;
            case Form::MegaRegenerate:
                device_->launch(Kernel::MegaRegenerate, features_, launch_, 0);
                break;
            case Form::Wave:
                run_rounds();
                break;
        }
        std::array<Counters, 1> counted;
        counters_.copy_out(counted);
        count_progress(paths);
        return report_of(paths, counted[0], wall_seconds() - begin);
    }

    /// Rounds until no path is left. The counters of a batch of rounds are looked at while the next one runs, so that
    /// the device never waits; rounds of an empty pool cost little.
    void run_rounds() {
        constexpr int kRounds = 8;  // an even number, behind which the first pool is next
        const auto run = [&](Kernel kernel) {
            device_->launch(kernel, features_, launch_, kernel == Kernel::BeginRound ? 1 : 0);
        };
        for (int batch = 0;; ++batch) {
            for (int round = 0; round < kRounds; ++round) {
                launch_.pool = round % 2;
                for (const Kernel kernel : {Kernel::Generate, Kernel::BeginRound, Kernel::Intersect, Kernel::Shade})
                    run(kernel);
                if (launch_.wave.shadow_rays != nullptr) run(Kernel::Shadow);
            }
            device_->begin_fetch(batch % 2, counters_.data());
            if (batch == 0) continue;
            const Counters counted = device_->fetched((batch - 1) % 2);
            count_progress(static_cast<std::int64_t>(counted.next_path) - counted.live[0]);
            if (counted.live[0] == 0 && static_cast<std::int64_t>(counted.next_path) == launch_.path_count) return;
        }
    }

    /// Those of the form.
    [[nodiscard]] std::vector<Kernel> kernels() const {
        if (form_ == Form::Mega) return {Kernel::Mega};
        if (form_ == Form::MegaRegenerate) return {Kernel::MegaRegenerate};
        return {Kernel::Generate, Kernel::BeginRound, Kernel::Intersect, Kernel::Shade, Kernel::Shadow};
    }

    void count_progress(std::int64_t paths) {
        if (settings_.progress != nullptr) settings_.progress->paths += paths - finished_;
        finished_ = paths;
    }

    RenderReport report_of(std::int64_t paths, const Counters& counted, double seconds) {
        finished_ = 0;
        RenderReport report;
        report.seconds = seconds;
        const auto own = std::make_shared<GpuReport>();
        own->kernel_s = device_->kernel_seconds();
        own->rounds = counted.rounds;
        report.engine = own;
        ThreadReport& thread = report.threads.emplace_back();
        thread.paths = paths;
        thread.segments = static_cast<std::int64_t>(counted.segments);
        thread.shadow_rays = static_cast<std::int64_t>(counted.shadow_rays);
        thread.busy_s = own->kernel_s;
        thread.wait_s = seconds - own->kernel_s;
        report.statistics = {static_cast<std::int64_t>(counted.non_finite), static_cast<std::int64_t>(counted.clamped),
                             counted.clamped_energy};
        return report;
    }

    RenderReport collect() override {
        const double begin = wall_seconds();
        std::vector<std::int64_t> added(framebuffer_.sums().size());
        sums_.copy_out(added);
        for (std::size_t i = 0; i < added.size(); ++i) framebuffer_.sums()[i] += added[i];
        clear_sums();
        RenderReport report;
        report.seconds = wall_seconds() - begin;
        report.threads.emplace_back().wait_s = report.seconds;
        return report;
    }
    void clear_sums() { sums_.copy_in(std::vector<std::int64_t>(sums_.size())); }

    double begin_s_;
    RenderSettings settings_;
    Framebuffer& framebuffer_;
    Form form_;
    std::unique_ptr<Device> device_;  ///< outlives what is in its memory
    std::size_t features_ = 0;
    std::unique_ptr<DeviceScene> scene_;
    DeviceArray<std::int64_t> sums_;
    DeviceArray<Counters> counters_;
    DeviceArray<std::uint32_t> records_[2];
    DeviceArray<std::uint32_t> hits_;
    DeviceArray<std::uint32_t> shadow_rays_;
    DeviceArray<std::uint32_t> pixels_;
    Launch launch_;
    std::int64_t finished_ = 0;  ///< paths of the unit that were told
};

void refuse(bool is_asked, const char* option, const char* why) {
    if (is_asked) throw InputError(fmt::format("{}: not with --engine gpu, {}", option, why));
}

}  // namespace

std::size_t pool_record_bytes(const Features& needed) {
    return columns_of(compiled_features_index(needed, kFirstFeatures) - kFirstFeatures).bytes(1);
}

void add_engines(EngineRegistry& registry, const DeviceMaker& device, const std::function<bool()>& has_device) {
    registry.add(
        {.name = "gpu",
         .description = "the same kernels on a GPU",
         .keeps_costs = false,
         .has_pool = false,
         .can_render =
             [has_device](const RenderSettings& settings) { return settings.split_depth == 0 && has_device(); },
         .make =
             [device](const std::any& options) {
                 const auto* gpu = std::any_cast<GpuSettings>(&options);
                 return std::make_unique<GpuEngine>(gpu == nullptr ? GpuSettings{} : *gpu, device);
             }});
}

const GpuReport& gpu_report(const RenderReport& report) {
    static const GpuReport kNone;
    const auto* own = dynamic_cast<const GpuReport*>(report.engine.get());
    return own == nullptr ? kNone : *own;
}

void GpuReport::add(const EngineReport& later) {
    const auto& other = dynamic_cast<const GpuReport&>(later);
    kernel_s += other.kernel_s;
    rounds += other.rounds;
}

std::unique_ptr<RenderSession> GpuEngine::begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                Framebuffer& framebuffer) const {
    refuse(settings.split_depth > 0, "--split-depth", "which follows one branch");
    refuse(settings.cost_image != nullptr, "--cost-image", "which does not know what a pixel costs");
    refuse(settings.count_work, "--count-work", "which counts no tests");
    refuse(settings.trace != nullptr, "--trace", "whose threads are too many to be drawn");
    return std::make_unique<GpuSession>(scene, settings, framebuffer, gpu_, device_);
}

std::unique_ptr<RenderSession> GpuEngine::begin(const CompiledScene<double>&, const RenderSettings&,
                                                Framebuffer&) const {
    throw InputError("--precision: --engine gpu has single precision alone");
}

}  // namespace raypool::gpu
