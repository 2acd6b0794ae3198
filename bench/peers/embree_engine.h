/// The peer: Embree 3 finds the closest hits, and all else is the engines' own.
///
/// Called by `raypool compare`, by the ladder study and by tests. The physics, the tests of shapes and the loop over
/// the image are those of core/ and recursive/, so that nothing but traversal differs, and the hash is that of every
/// engine.
#pragma once

#include "core/runtime/engine.h"

namespace raypool::peers {

enum class EmbreeRays : std::uint8_t {
    Single,  ///< a path at a time, rtcIntersect1
    Packet,  ///< a register of paths at a time, rtcIntersect16 or 8; a path that ends makes room for the next camera
             ///< ray
};

class EmbreeEngine : public Engine {
  public:
    explicit EmbreeEngine(EmbreeRays rays) : rays_(rays) {}
    [[nodiscard]] std::string name() const override {
        return rays_ == EmbreeRays::Single ? "embree-1" : "embree-packet";
    }
    /// Builds Embree's trees, in one thread, which the report leaves out as it does compile(). Throws InputError for
    /// what it has not: split_depth, count_work, a cost image; std::runtime_error where Embree fails.
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>&, const RenderSettings&,
                                                       Framebuffer&) const override;
    /// Throws InputError: Embree traces in single precision.
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>&, const RenderSettings&,
                                                       Framebuffer&) const override;

  private:
    EmbreeRays rays_;
};

}  // namespace raypool::peers
