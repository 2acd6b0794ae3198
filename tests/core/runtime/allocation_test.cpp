/// What is allocated, counted where every allocation comes by: operator new of this program.
///
/// A compiled scene says all of its bytes; and memory that cannot be had, in whatever thread and at whatever step of a
/// render, is an exception that reaches the caller, never the end of the program.
#include <atomic>
#include <cstdlib>
#include <new>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/runtime/trace.h"
#include "tests/small_render.h"
#include "wavefront/engine.h"

namespace {

std::atomic<std::size_t> allocated_bytes = 0;
std::atomic<std::int64_t> allocations_left = -1;  ///< until one fails, once; negative: none will

void* allocate(std::size_t size, std::size_t alignment) {
    allocated_bytes += size;
    std::int64_t left = allocations_left.load();
    while (left >= 0 && !allocations_left.compare_exchange_weak(left, left - 1)) continue;
    if (left == 0) throw std::bad_alloc();
    void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
    return allocate(std::max<std::size_t>(size, 1), alignof(std::max_align_t));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(std::max<std::size_t>(size, 1), static_cast<std::size_t>(alignment));
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept try {
    return operator new(size);
} catch (const std::bad_alloc&) {
    return nullptr;
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace raypool {
namespace {

template <class Scalar>
void expect_all_bytes_said(const char* name) {
    const CompiledScene<Scalar> scene = compile<Scalar>(small_scene(name, 8));
    const std::size_t before = allocated_bytes;
    const CompiledScene<Scalar> shared = scene;
    EXPECT_EQ(allocated_bytes, before) << name << ": a copy sees the same tables";
    EXPECT_EQ(shared.bytes(), scene.bytes());
    const SceneTables<Scalar> copy = scene.tables();
    EXPECT_EQ(scene.bytes() - sizeof(scene) - sizeof(copy), allocated_bytes - before) << name << ": tables have slack";
}

TEST(CompiledSceneBytes, AreAllThatItsTablesTake) {
    for (const char* name : {"paper", "cornell", "glass_stack", "textures", "one_sphere"}) {
        expect_all_bytes_said<float>(name);
        expect_all_bytes_said<double>(name);
    }
}

/// Renders again and again, each time with the next allocation failing, until a render needs no more. Returns how many
/// failed.
int fail_at_every_allocation(const Engine& engine, const CompiledScene<float>& scene, RenderSettings settings) {
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(1, scene.max_radiance));
    const std::string empty = framebuffer.hash();
    engine.render(scene, settings, framebuffer);  // whatever OpenMP's threads allocate for themselves is there now
    for (int failed = 0;; ++failed) {
        Framebuffer out(scene.width, scene.height, FixedPoint::make(1, scene.max_radiance));
        Trace trace;
        if (settings.trace != nullptr) settings.trace = &trace;
        bool is_refused = false;
        allocations_left = failed;
        try {
            engine.render(scene, settings, out);
        } catch (const std::bad_alloc&) {
            is_refused = true;
        } catch (const InputError&) {
            is_refused = true;
        }
        const bool is_over = allocations_left >= 0;
        allocations_left = -1;
        if (is_refused) {
            EXPECT_EQ(out.hash(), empty) << failed;
        } else {
            EXPECT_EQ(out.hash(), framebuffer.hash()) << failed;
        }
        if (is_over) return failed;
    }
}

TEST(FailedAllocation, ReachesTheCallerOfARenderFromWhateverThreadWithNothingAdded) {
    using namespace wavefront;
    const CompiledScene<float> scene = compile<float>(small_scene("glass_stack", 12));
    Trace trace;
    for (const bool is_traced : {false, true}) {
        RenderSettings settings;
        settings.end_sample = 1;
        settings.threads = 3;
        if (is_traced) settings.trace = &trace;
        EXPECT_GT(fail_at_every_allocation(recursive::RecursiveEngine(), scene, settings), 3);
        EXPECT_GT(fail_at_every_allocation(recursive::IterativeEngine(), scene, settings), 3);
        for (const PoolScope scope : {PoolScope::PerThread, PoolScope::Shared}) {
            for (const Append append : {Append::InPlace, Append::Atomic, Append::PrefixSum}) {
                if (scope == PoolScope::PerThread && append != Append::InPlace) continue;
                const PoolSettings pool{.scope = scope,
                                        .append = append,
                                        .accumulator = Accumulator::PrivateInt64,
                                        .capacity = 100,
                                        .batch = 30};
                EXPECT_GT(fail_at_every_allocation(WavefrontEngine(pool), scene, settings), 10);
            }
        }
    }
}

}  // namespace
}  // namespace raypool
