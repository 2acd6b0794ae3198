/// The GPU engine: the same kernels, compiled for a GPU, in one of three forms. Same image as every engine, to the last
/// bit (docs/gpu.md).
///
/// It has single precision, one device and no splitting, and counts no tests; what it cannot do it refuses by the name
/// of the option.
#pragma once

#include <functional>
#include <memory>

#include "core/runtime/engine.h"
#include "core/runtime/registry.h"
#include "gpu/device.h"
#include "gpu/settings.h"

namespace raypool::gpu {

/// Makes the device to render on; the host takes as many threads.
using DeviceMaker = std::function<std::unique_ptr<Device>(int threads)>;

class GpuEngine : public Engine {
  public:
    GpuEngine(const GpuSettings& gpu, DeviceMaker device) : gpu_(gpu), device_(std::move(device)) {}
    [[nodiscard]] std::string name() const override { return "gpu"; }
    [[nodiscard]] bool loops_over_image() const override { return false; }
    /// Throws InputError for settings and scenes that it cannot render, and std::runtime_error for what the device's
    /// driver says.
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>&, const RenderSettings&,
                                                       Framebuffer&) const override;
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>&, const RenderSettings&,
                                                       Framebuffer&) const override;

  private:
    GpuSettings gpu_;
    DeviceMaker device_;
};

/// What the pool of Form::Wave takes for each of its records: two of them, a hit, and a shadow ray where lights are
/// sampled. `needed` are a scene's features (needed_features()).
std::size_t pool_record_bytes(const Features& needed);

/// Its options are GpuSettings.
void add_engines(EngineRegistry& registry, const DeviceMaker& device, const std::function<bool()>& has_device);

/// What the engine adds to the report.
class GpuReport : public EngineReport {
  public:
    std::string device;
    double kernel_s = 0;        ///< of `seconds`, while kernels ran
    std::int64_t rounds = 0;    ///< of Form::Wave
    std::int64_t capacity = 0;  ///< records of its pool

    [[nodiscard]] std::shared_ptr<EngineReport> copy() const override { return std::make_shared<GpuReport>(*this); }
    void add(const EngineReport& later) override;
};

/// What the engine reported of a render; all zero of another engine's.
const GpuReport& gpu_report(const RenderReport& report);

}  // namespace raypool::gpu
