/// How a pool stores ray records: structure-of-arrays, a column a field. Storage, loading, storing and moving derive
/// from the list of fields in core/shading/ray_record.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>

#include "core/shading/ray_record.h"

namespace raypool::wavefront {

template <class T>
struct LaneOf {
    using Type = T;
};
template <Simd V>
struct LaneOf<V> {
    using Type = typename V::value_type;
};

/// Room after the last record, so that a whole register can be loaded and stored anywhere.
inline constexpr std::size_t kPadding = 16;

/// The features that a record shows: scenes that agree in them have one kind of record.
constexpr Features record_features(const Features& features) {
    Features shown;
    shown.motion = features.motion;
    shown.lights = features.lights;
    return shown;
}

/// Columns of `capacity` records. Not synchronised; threads may work on ranges that do not share records.
template <Features features, class Scalar>
class ColumnsOfKind {
  public:
    /// 0 records take no memory.
    explicit ColumnsOfKind(std::size_t capacity)
        : stride_(capacity + kPadding), memory_(new (std::align_val_t(64)) std::byte[bytes(capacity)]) {
        std::memset(memory_.get(), 0, bytes(capacity));  // lanes beyond the last record hold ids that exist
    }

    static constexpr std::size_t bytes(std::size_t capacity) {
        return record_bytes<features, Scalar>() * (capacity + kPadding);
    }

    /// Records first, first + 1, ... by lane.
    template <class Real>
    RAYPOOL_INLINE RayRecord<Real> load(std::size_t first) const {
        RayRecord<Real> record;
        record.ray.time = record.density = Real(0);
        const std::byte* column = memory_.get();
        for_each_field<features>(record, [&](auto& field) {
            using T = typename LaneOf<std::remove_cvref_t<decltype(field)>>::Type;
            const T* from = reinterpret_cast<const T*>(column) + first;
            if constexpr (Simd<Real>) {
                field.copy_from(from, stdx::element_aligned);
            } else {
                field = *from;
            }
            column += stride_ * sizeof(T);
        });
        return record;
    }

    /// Stores the lanes set in `bits`, one after the other from `first`. Writes to no record from `end` on, which may
    /// be another thread's; what lies between the last lane stored and `end` is garbage afterwards.
    template <class Real>
    RAYPOOL_INLINE void append(std::size_t first, const RayRecord<Real>& record, unsigned bits, std::size_t end) {
        std::byte* column = memory_.get();
        if (first + kLanes<Real> <= end) [[likely]] {
            const LanePacker<Real> packer(bits);
            for_each_field<features>(record, [&](const auto& field) {
                using T = typename LaneOf<std::remove_cvref_t<decltype(field)>>::Type;
                packer.store(reinterpret_cast<T*>(column) + first, field);
                column += stride_ * sizeof(T);
            });
        } else {
            append_by_lane(first, record, bits);
        }
    }

    /// Copies `count` records to another place, which may be in another pool. Ranges do not overlap.
    void copy_to(ColumnsOfKind& other, std::size_t target, std::size_t first, std::size_t count) const {
        RayRecord<Scalar> record;
        const std::byte* from = memory_.get();
        std::byte* to = other.memory_.get();
        for_each_field<features>(record, [&](const auto& field) {
            std::memcpy(to + target * sizeof(field), from + first * sizeof(field), count * sizeof(field));
            from += stride_ * sizeof(field);
            to += other.stride_ * sizeof(field);
        });
    }

    /// Puts record order[i] of range [first, first + count) to first + i, by way of `scratch` (count * 8 bytes).
    void permute(std::size_t first, std::size_t count, const std::uint32_t* order, std::byte* scratch) {
        RayRecord<Scalar> record;
        std::byte* column = memory_.get();
        for_each_field<features>(record, [&](const auto& field) {
            using T = std::remove_cvref_t<decltype(field)>;
            T* values = reinterpret_cast<T*>(column) + first;
            T* sorted = reinterpret_cast<T*>(scratch);
            for (std::size_t i = 0; i < count; ++i) sorted[i] = values[order[i]];
            std::memcpy(values, sorted, count * sizeof(T));
            column += stride_ * sizeof(T);
        });
    }

  private:
    template <class Real>
    [[gnu::noinline]] void append_by_lane(std::size_t first, const RayRecord<Real>& record, unsigned bits) {
        std::byte* column = memory_.get();
        for_each_field<features>(record, [&](const auto& field) {
            using T = typename LaneOf<std::remove_cvref_t<decltype(field)>>::Type;
            T* target = reinterpret_cast<T*>(column) + first;
            for (unsigned left = bits; left != 0; left &= left - 1) *target++ = lane(field, std::countr_zero(left));
            column += stride_ * sizeof(T);
        });
    }

    struct Delete {
        void operator()(std::byte* memory) const { ::operator delete[](memory, std::align_val_t(64)); }
    };
    std::size_t stride_;
    std::unique_ptr<std::byte[], Delete> memory_;
};

/// The columns for a scene: one type for each kind of record.
template <Features features, class Scalar>
using RayColumns = ColumnsOfKind<record_features(features), Scalar>;

}  // namespace raypool::wavefront
