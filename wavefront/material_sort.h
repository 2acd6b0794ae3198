/// Records in the order of the materials that they hit, so that a register is mostly of one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/shading/compiled_scene.h"
#include "wavefront/ray_columns.h"
#include "wavefront/stream.h"

namespace raypool::wavefront {

/// A counting sort by material kind, misses last. Of one thread.
template <class Scalar>
class MaterialSort {
  public:
    /// For batches of at most `most_records`, where the settings ask for it.
    MaterialSort(Sort sort, std::size_t most_records) : scratch_(sort == Sort::None ? 0 : most_records) {}
    static std::size_t bytes(Sort sort, std::size_t most_records) {
        return sort == Sort::None ? 0 : most_records * sizeof(double);
    }

    /// Of records [first, first + count), whose hits are in `stream`. `lists` are scratch.
    template <class Records>
    void run(const SceneView<Scalar>& scene, Records& records, std::size_t first, std::size_t count,
             RayStream<Scalar>& stream, const StreamLists<Scalar>& lists) {
        constexpr std::size_t kKinds = Material::kKindCount + 1;
        const auto kind = [&](std::size_t i) -> std::size_t {
            const std::int32_t id = stream.primitive_id()[i];
            if (id < 0) return kKinds - 1;
            const auto& row = scene.surfaces[static_cast<std::size_t>(surface_of<Scalar>(scene, id))];
            const Int<Scalar> code = bits_of<Scalar>(row.value[SurfaceRow<Scalar>::kCode]);
            return static_cast<std::size_t>(SurfaceCode<Int<Scalar>>{code}.material());
        };
        std::size_t place[kKinds + 1] = {};
        for (std::size_t i = 0; i < count; ++i) ++place[kind(i) + 1];
        for (std::size_t k = 1; k <= kKinds; ++k) place[k] += place[k - 1];
        std::uint32_t* order = lists.data();
        for (std::size_t i = 0; i < count; ++i) order[place[kind(i)]++] = static_cast<std::uint32_t>(i);
        auto* scratch = reinterpret_cast<std::byte*>(scratch_.data());
        records.permute(first, count, order, scratch);
        permute(stream.distance(), order, count, scratch);
        permute(stream.primitive_id(), order, count, scratch);
    }

  private:
    template <class T>
    static void permute(T* values, const std::uint32_t* order, std::size_t count, std::byte* scratch) {
        T* sorted = reinterpret_cast<T*>(scratch);
        for (std::size_t i = 0; i < count; ++i) sorted[i] = values[order[i]];
        std::copy_n(sorted, count, values);
    }

    std::vector<double> scratch_;
};

}  // namespace raypool::wavefront
