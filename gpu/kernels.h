/// The bodies of all kernels, for the threads of a GPU and of the host.
///
/// Form::Mega and Form::MegaRegenerate are one kernel each. Form::Wave is rounds of five, over two pools in the
/// device's memory: Generate fills the pool with camera rays, BeginRound counts them, Intersect finds hits, Shade moves
/// what goes on to the other pool and queues rays toward lights, Shadow follows these. No kernel asks the host for
/// anything.
#pragma once

#include <bit>
#include <cstdint>

#include "gpu/path.h"
#include "gpu/threads.h"

namespace raypool::gpu {

enum class Kernel : std::uint8_t { Mega, MegaRegenerate, Generate, BeginRound, Intersect, Shade, Shadow };
inline constexpr int kKernelCount = 7;

namespace detail {

/// What an item of a pool has, as numbers of 32 bits; the list of a record is for_each_field().
template <Features features, class Record, class Visit>
RAYPOOL_INLINE void for_each_word(Record& record, Visit visit) requires requires {
    record.throughput;
}
{ for_each_field<features>(record, visit); }
template <Features, class HitFound, class Visit>
RAYPOOL_INLINE void for_each_word(HitFound& hit, Visit visit) requires requires {
    hit.primitive_id;
}
{
    visit(hit.t);
    visit(hit.primitive_id);
}
template <Features features, class Shadow, class Visit>
RAYPOOL_INLINE void for_each_word(Shadow& shadow, Visit visit) requires requires {
    shadow.light_id;
}
{
    for (int i = 0; i < 3; ++i) visit(shadow.ray.origin[i]);
    for (int i = 0; i < 3; ++i) visit(shadow.ray.direction[i]);
    if constexpr (features.motion) visit(shadow.ray.time);
    visit(shadow.leaving_id);
    visit(shadow.t);
    visit(shadow.light_id);
    for (int i = 0; i < 3; ++i) visit(shadow.radiance[i]);
    visit(shadow.cell);
}

}  // namespace detail

/// How many columns an item takes.
template <Features features, class Item>
constexpr std::size_t column_count() {
    Item item{};
    std::size_t count = 0;
    detail::for_each_word<features>(item, [&](const auto&) { ++count; });
    return count;
}

/// Item i of columns that are `stride` long.
template <Features features, class Item>
RAYPOOL_INLINE void store(std::uint32_t* columns, std::uint32_t stride, std::int64_t i, const Item& item) {
    std::uint32_t* at = columns + i;
    detail::for_each_word<features>(item, [&](const auto& word) {
        *at = std::bit_cast<std::uint32_t>(word);
        at += stride;
    });
}
template <Features features, class Item>
RAYPOOL_INLINE Item load(const std::uint32_t* columns, std::uint32_t stride, std::int64_t i) {
    Item item{};
    const std::uint32_t* at = columns + i;
    detail::for_each_word<features>(item, [&](auto& word) {
        word = std::bit_cast<std::remove_reference_t<decltype(word)>>(*at);
        at += stride;
    });
    return item;
}

/// A thread's run of a kernel.
template <Features features, class Thread>
class KernelRun {
  public:
    RAYPOOL_INLINE KernelRun(const Launch& launch, const Thread& thread)
        : launch_(launch), counters_(*launch.counters), thread_(thread), converter_(launch.converter) {}

    template <Kernel kernel>
    RAYPOOL_INLINE void run() {
        if constexpr (kernel == Kernel::Mega) mega();
        if constexpr (kernel == Kernel::MegaRegenerate) mega_regenerate();
        if constexpr (kernel == Kernel::Generate) generate();
        if constexpr (kernel == Kernel::BeginRound) begin_round();
        if constexpr (kernel == Kernel::Intersect) intersect();
        if constexpr (kernel == Kernel::Shade) shade_pool();
        if constexpr (kernel == Kernel::Shadow) follow_shadow_rays();
        report();
    }

  private:
    using Record = RayRecord<float>;

    /// A thread a path, to its end: the paper's version for a GPU.
    RAYPOOL_INLINE void mega() {
        for_each(thread_, launch_.path_count, [&](std::int64_t path, bool is_there) {
            if (!is_there) return;
            Record record = camera_record<features>(launch_, path);
            while (follow(record)) {
            }
        });
    }

    /// A thread whose path ends takes the next one, so that no lane of a warp waits for the longest path.
    RAYPOOL_INLINE void mega_regenerate() {
        Record record;
        bool is_alive = false;
        bool are_more = true;
        for (;;) {
            const bool is_wanted = !is_alive && are_more;
            const auto path = static_cast<std::int64_t>(thread_.append(&counters_.next_path, is_wanted));
            if (is_wanted) {
                are_more = path < launch_.path_count;
                is_alive = are_more;
                if (is_alive) record = camera_record<features>(launch_, path);
            }
            if (!thread_.any(is_alive)) return;
            if (is_alive) is_alive = follow(record);
        }
    }

    /// Camera rays that there is room for.
    [[nodiscard]] RAYPOOL_INLINE std::int64_t generated() const {
        const std::int64_t left = launch_.path_count - static_cast<std::int64_t>(counters_.next_path);
        const std::int64_t room = std::int64_t{launch_.wave.capacity} - counters_.live[launch_.pool];
        return left < room ? left : room;
    }
    RAYPOOL_INLINE void generate() {
        for_each(thread_, generated(), [&](std::int64_t i, bool is_there) {
            if (!is_there) return;
            const auto path = static_cast<std::int64_t>(counters_.next_path) + i;
            put(launch_.pool, counters_.live[launch_.pool] + i, camera_record<features>(launch_, path));
        });
    }
    RAYPOOL_INLINE void begin_round() {
        if (thread_.index != 0) return;
        const std::int64_t made = generated();
        counters_.next_path += static_cast<std::uint64_t>(made);
        std::uint32_t& live = counters_.live[launch_.pool];
        live += static_cast<std::uint32_t>(made);
        counters_.live[1 - launch_.pool] = 0;
        counters_.queued = 0;
        counters_.segments += live;
        if (live != 0) ++counters_.rounds;
    }
    RAYPOOL_INLINE void intersect() {
        for_each(thread_, counters_.live[launch_.pool], [&](std::int64_t i, bool is_there) {
            if (!is_there) return;
            const Hit<float> hit = trace<features>(launch_, get(i));
            store<features>(launch_.wave.hits, launch_.wave.capacity, i, hit);
        });
    }
    RAYPOOL_INLINE void shade_pool() {
        for_each(thread_, counters_.live[launch_.pool], [&](std::int64_t i, bool is_there) {
            Record record;
            ShadowRay shadow;
            bool is_alive = false;
            bool has_shadow_ray = false;
            if (is_there) {
                record = get(i);
                const auto hit = load<features, Hit<float>>(launch_.wave.hits, launch_.wave.capacity, i);
                is_alive = shade<features>(
                    launch_, hit, record, [&](const Vec3<float>& radiance) { add(cell_of(record), radiance); },
                    [&](const ShadowRay& found) {
                        shadow = found;
                        has_shadow_ray = true;
                    });
            }
            if constexpr (features.lights) {
                const std::uint32_t place = thread_.append(&counters_.queued, has_shadow_ray);
                if (has_shadow_ray) store<features>(launch_.wave.shadow_rays, launch_.wave.capacity, place, shadow);
            }
            const std::uint32_t place = thread_.append(&counters_.live[1 - launch_.pool], is_alive);
            if (is_alive) put(1 - launch_.pool, place, record);
        });
    }
    RAYPOOL_INLINE void follow_shadow_rays() {
        for_each(thread_, counters_.queued, [&](std::int64_t i, bool is_there) {
            if (!is_there) return;
            const auto shadow = load<features, ShadowRay>(launch_.wave.shadow_rays, launch_.wave.capacity, i);
            ++shadow_rays_;
            if (is_seen<features>(launch_, shadow)) add(shadow.cell, shadow.radiance);
        });
    }

    /// A segment of a path, with the ray toward a light at its end. Returns whether there is another.
    RAYPOOL_INLINE bool follow(Record& record) {
        ++segments_;
        const Hit<float> hit = trace<features>(launch_, record);
        return shade<features>(
            launch_, hit, record, [&](const Vec3<float>& radiance) { add(cell_of(record), radiance); },
            [&](const ShadowRay& shadow) {
                ++shadow_rays_;
                if (is_seen<features>(launch_, shadow)) add(shadow.cell, shadow.radiance);
            });
    }

    [[nodiscard]] RAYPOOL_INLINE std::uint32_t cell_of(const Record& record) const {
        return raypool::cell_of<std::uint32_t>(launch_.has_halves, record.key.pixel, record.key.sample);
    }
    RAYPOOL_INLINE void add(std::uint32_t cell, const Vec3<float>& radiance) {
        const FixedRgb fixed = converter_.convert<float>(radiance);
        for (int i = 0; i < 3; ++i)
            if (fixed[i] != 0) thread_.add(launch_.sums + 3 * std::int64_t{cell} + i, fixed[i]);
    }

    [[nodiscard]] RAYPOOL_INLINE Record get(std::int64_t i) const {
        return load<features, Record>(launch_.wave.records[launch_.pool], launch_.wave.capacity, i);
    }
    RAYPOOL_INLINE void put(int pool, std::int64_t i, const Record& record) {
        store<features>(launch_.wave.records[pool], launch_.wave.capacity, i, record);
    }

    /// Adds what this thread counted; for all threads of a warp. What is wrong with samples is rare.
    RAYPOOL_INLINE void report() {
        const auto add_if = [&](auto* to, auto value) {
            if (value != 0) thread_.add(to, static_cast<std::remove_reference_t<decltype(*to)>>(value));
        };
        thread_.add_all(&counters_.segments, segments_);
        thread_.add_all(&counters_.shadow_rays, shadow_rays_);
        const SampleStatistics& statistics = converter_.statistics();
        add_if(&counters_.non_finite, statistics.non_finite);
        add_if(&counters_.clamped, statistics.clamped);
        add_if(&counters_.clamped_energy, statistics.clamped_energy);
    }

    const Launch& launch_;
    Counters& counters_;
    Thread thread_;
    SampleConverter converter_;
    std::uint64_t segments_ = 0;
    std::uint64_t shadow_rays_ = 0;
};

template <Kernel kernel, Features features, class Thread>
RAYPOOL_INLINE void run_kernel(const Launch& launch, const Thread& thread) {
    KernelRun<features, Thread>(launch, thread).template run<kernel>();
}

}  // namespace raypool::gpu
