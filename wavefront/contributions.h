/// Radiance on its way to the framebuffer: collected while a batch is shaded, added when it is done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/math/vec.h"

namespace raypool::wavefront {

/// Radiance that ended in each pixel, in columns. One per thread.
template <class Scalar>
class Contributions {
  public:
    /// Room for `count` in all.
    void reserve(std::size_t count) {
        for (auto& column : rgb_) column.resize(count + kRoom);
        pixel_.resize(count + kRoom);
    }
    static std::size_t bytes(std::size_t count) {
        return (count + kRoom) * (3 * sizeof(Scalar) + sizeof(std::uint32_t));
    }

    /// The lanes set in `bits`.
    template <class Real>
    RAYPOOL_INLINE void put(const Uint32<Real>& pixel, const Vec3<Real>& radiance, unsigned bits) {
        const LanePacker<Real> packer(bits);
        packer.store(pixel_.data() + count_, pixel);
        for (int i = 0; i < 3; ++i) packer.store(rgb_[i].data() + count_, radiance[i]);
        count_ += static_cast<std::size_t>(std::popcount(bits));
    }
    /// The lanes set in `bits` of those of `from` that begin at `first`.
    template <class Real>
    RAYPOOL_INLINE void put_from(const Contributions& from, std::size_t first, unsigned bits) {
        const auto load = [first]<class V>(const auto& column, V) {
            if constexpr (Simd<Real>) {
                return V(column.data() + first, stdx::element_aligned);
            } else {
                return column[first];
            }
        };
        Vec3<Real> radiance;
        for (int i = 0; i < 3; ++i) radiance[i] = load(from.rgb_[i], Real());
        put<Real>(load(from.pixel_, Uint32<Real>()), radiance, bits);
    }
    void clear() { count_ = 0; }

    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::uint32_t pixel(std::size_t i) const { return pixel_[i]; }
    [[nodiscard]] Vec3<Scalar> radiance(std::size_t i) const {
        return vec3<Scalar>(rgb_[0][i], rgb_[1][i], rgb_[2][i]);
    }

    /// Channel k of this one and of those behind it.
    [[nodiscard]] const Scalar* channel(int k, std::size_t i) const { return rgb_[k].data() + i; }

  private:
    static constexpr std::size_t kRoom = 16;  ///< of a register stored whole
    std::size_t count_ = 0;
    std::vector<std::uint32_t> pixel_;
    std::vector<Scalar> rgb_[3];
};

}  // namespace raypool::wavefront
