// The bodies of the GPU's kernels, run by the host, make the image of every other engine.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/image/cost_image.h"
#include "core/runtime/trace.h"
#include "gpu/device_scene.h"
#include "gpu/host_device.h"
#include "tests/gpu/forms.h"

namespace raypool::gpu {
namespace {

class GpuForms : public testing::TestWithParam<FormCase> {};

TEST_P(GpuForms, MakeTheImageOfThePerPixelTracer) {
    check_forms(GetParam(), host_device);
}
INSTANTIATE_TEST_SUITE_P(Scenes, GpuForms, testing::ValuesIn(kFormCases),
                         [](const auto& test) { return test.param.name; });

/// Renders units one after the other.
Rendered in_units(const GpuSettings& gpu, const CompiledScene<float>& scene, const RenderSettings& settings,
                  const std::vector<RenderUnit>& units, Halves halves = Halves::Together) {
    Rendered out{Framebuffer(scene.width, scene.height, fixed_point(scene, settings, settings.end_sample), halves),
                 {},
                 settings.end_sample};
    const GpuEngine engine(gpu, host_device);
    const auto session = engine.begin(scene, settings, out.framebuffer);
    for (const RenderUnit& unit : units) {
        session->add(unit);
        if (unit.first_sample == 1) session->merge();  // more may be added behind it
    }
    out.report = session->finish();
    return out;
}

TEST(GpuSession, AddsUpRangesOfSamplesAndPartsOfTheImage) {
    const CompiledScene<float> scene = compile<float>(small_scene("cornell", 20));
    RenderSettings settings;
    settings.end_sample = 5;
    const Rendered expected = render(recursive::IterativeEngine(), scene, settings);
    std::vector<std::uint32_t> odd;
    std::vector<std::uint32_t> even;
    for (std::uint32_t pixel = 0; pixel < scene.pixel_count(); ++pixel) (pixel % 2 == 0 ? even : odd).push_back(pixel);
    for (const GpuSettings& gpu : kForms) {
        const Rendered got =
            in_units(gpu, scene, settings, {{0, 1, nullptr}, {1, 3, nullptr}, {3, 5, &odd}, {3, 5, &even}});
        EXPECT_EQ(got.hash(), expected.hash()) << describe(gpu);
        EXPECT_EQ(got.report.segments(), expected.report.segments()) << describe(gpu);
        EXPECT_EQ(got.report.paths(), expected.report.paths()) << describe(gpu);
    }
}

TEST(GpuSession, KeepsHalvesApartAsOthersDo) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 16));
    RenderSettings settings;
    settings.end_sample = 6;
    Framebuffer expected(scene.width, scene.height, fixed_point(scene, settings, 6), Halves::Apart);
    recursive::IterativeEngine().render(scene, settings, expected);
    for (const GpuSettings& gpu : kForms)
        EXPECT_EQ(in_units(gpu, scene, settings, {{0, 6, nullptr}}, Halves::Apart).hash(), expected.hash());
}

TEST(GpuSession, TellsItsProgress) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 16));
    for (const GpuSettings& gpu : kForms) {
        Progress progress;
        RenderSettings settings;
        settings.end_sample = 3;
        settings.progress = &progress;
        in_units(gpu, scene, settings, {{0, 1, nullptr}, {1, 3, nullptr}});
        EXPECT_EQ(progress.paths, 3 * scene.pixel_count()) << describe(gpu);
    }
}

TEST(GpuSession, RefusesWhatItCannotDoByName) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 16));
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(1, 1));
    const GpuEngine engine({}, host_device);
    const auto refusal = [&](const RenderSettings& settings) -> std::string {
        try {
            (void)engine.begin(scene, settings, framebuffer);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    RenderSettings splits;
    splits.split_depth = 1;
    EXPECT_NE(refusal(splits).find("--split-depth"), std::string::npos);
    CostImage costs(Cost::Segments, 16, 9);
    RenderSettings has_costs;
    has_costs.cost_image = &costs;
    EXPECT_NE(refusal(has_costs).find("--cost-image"), std::string::npos);
    RenderSettings counts;
    counts.count_work = true;
    EXPECT_NE(refusal(counts).find("--count-work"), std::string::npos);
    Trace trace;
    RenderSettings has_trace;
    has_trace.trace = &trace;
    EXPECT_NE(refusal(has_trace).find("--trace"), std::string::npos);
    const CompiledScene<double> in_double = compile<double>(small_scene("paper", 16));
    EXPECT_THROW((void)engine.begin(in_double, {}, framebuffer), InputError);
}

/// The host with a megabyte of memory.
class SmallDevice : public Device {
  public:
    [[nodiscard]] std::string name() const override { return "a small device"; }
    [[nodiscard]] std::size_t free_bytes() const override { return 1'000'000; }
    void make_ready(std::span<const Kernel> kernels, std::size_t features) override {
        host_->make_ready(kernels, features);
    }
    [[nodiscard]] void* allocate(std::size_t bytes) override { return host_->allocate(bytes); }
    void release(void* memory) override { host_->release(memory); }
    void copy_in(void* to, const void* from, std::size_t bytes) override { host_->copy_in(to, from, bytes); }
    void copy_out(void* to, const void* from, std::size_t bytes) override { host_->copy_out(to, from, bytes); }
    void launch(Kernel kernel, std::size_t features, const Launch& launch, std::int64_t items) override {
        host_->launch(kernel, features, launch, items);
    }
    [[nodiscard]] double kernel_seconds() override { return host_->kernel_seconds(); }
    void begin_fetch(int place, const Counters* counters) override { host_->begin_fetch(place, counters); }
    [[nodiscard]] Counters fetched(int place) override { return host_->fetched(place); }

  private:
    std::unique_ptr<Device> host_ = host_device(1);
};

TEST(GpuSession, RefusesAPoolThatDoesNotFitWithBothFigures) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 16));
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(1, 1));
    const auto small = [](int) { return std::make_unique<SmallDevice>(); };
    EXPECT_NO_THROW((void)GpuEngine({Form::Wave, 1000}, small).begin(scene, {}, framebuffer));
    try {
        (void)GpuEngine({Form::Wave, 1'000'000}, small).begin(scene, {}, framebuffer);
        ADD_FAILURE() << "not refused";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("--pool-rays"));
        EXPECT_THAT(error.what(), testing::HasSubstr(" MB, of 1.0 MB of the memory of a small device"));
    }
}

TEST(DeviceScene, HasACopyOfEveryTable) {
    for (const char* name : {"sky_image", "instances", "textures", "cornell"}) {
        const CompiledScene<float> scene = compile<float>(small_scene(name, 16));
        std::vector<const void*> tables;
        SceneTables<float>::for_each_table(scene.tables(), [&](const auto& table) { tables.push_back(table.data()); });
        std::size_t i = 0;
        SceneView<float>::for_each_span(scene, [&](const auto& rows) {
            ASSERT_LT(i, tables.size());
            EXPECT_EQ(rows.data(), tables[i]) << name << ", table " << i;
            ++i;
        });
        EXPECT_EQ(i, tables.size()) << name;

        const auto device = host_device(1);
        const DeviceScene copy(*device, scene);
        std::vector<std::span<const std::byte>> originals;
        SceneView<float>::for_each_span(scene, [&](const auto& rows) { originals.push_back(std::as_bytes(rows)); });
        auto original = originals.begin();
        SceneView<float>::for_each_span(copy.view(), [&](const auto& rows) {
            const auto bytes = std::as_bytes(rows);
            EXPECT_TRUE(std::ranges::equal(bytes, *original)) << name;
            EXPECT_TRUE(bytes.empty() || bytes.data() != original->data()) << name;
            ++original;
        });
    }
}

}  // namespace
}  // namespace raypool::gpu
