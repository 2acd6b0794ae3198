/// How evenly the passes of a render load its threads. Called by the study of adaptive sampling.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/runtime/engine.h"
#include "core/shading/compiled_scene.h"

namespace raypool::studies {

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

}  // namespace raypool::studies
