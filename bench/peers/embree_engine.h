/// The peer: Embree 3 finds the closest hits, and all else is the engines' own.
///
/// Called by `raypool compare`, by studies and by tests. The physics and the loop over the image are those of core/ and
/// recursive/, and so are the tests of shapes, so that nothing but traversal differs, and the hash is that of every
/// engine. Where triangles are Embree's own, at its full speed, a ray that passes along an edge may meet another
/// triangle than ours does, so the image may be another sample of the same.
#pragma once

#include "bench/peers/embree_scene.h"
#include "core/runtime/engine.h"

namespace raypool::peers {

enum class EmbreeRays : std::uint8_t {
    Single,  ///< a path at a time, rtcIntersect1
    Packet,  ///< a register of paths at a time, rtcIntersect16 or 8; a path that ends makes room for the next camera
             ///< ray
};

class EmbreeEngine : public Engine {
  public:
    explicit EmbreeEngine(EmbreeRays rays, EmbreeTriangles triangles = EmbreeTriangles::Ours)
        : rays_(rays), triangles_(triangles) {}
    [[nodiscard]] std::string name() const override {
        const std::string triangles = triangles_ == EmbreeTriangles::Ours ? "embree-" : "embree-mesh-";
        return triangles + (rays_ == EmbreeRays::Single ? "1" : "packet");
    }
    /// Whether its image need not be that of the other engines to the bit. In a scene without meshes it is.
    [[nodiscard]] bool is_independent(const CompiledScene<float>& scene) const {
        return triangles_ == EmbreeTriangles::Embrees && !scene.triangles.empty();
    }
    /// Builds Embree's trees, in one thread, which the report leaves out as it does compile(). Throws InputError for
    /// what it has not: instances, split_depth, count_work, a cost image; std::runtime_error where Embree fails.
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>&, const RenderSettings&,
                                                       Framebuffer&) const override;
    /// Throws InputError: Embree traces in single precision.
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>&, const RenderSettings&,
                                                       Framebuffer&) const override;

  private:
    EmbreeRays rays_;
    EmbreeTriangles triangles_;
};

/// Both kinds of rays, with triangles of ours; and for scenes with meshes, both with Embree's own.
std::vector<std::shared_ptr<const EmbreeEngine>> embree_engines(bool has_meshes);

}  // namespace raypool::peers
