/// What every benchmark shares: the refusal of a debug build, where the figures come from, and the rows' counters.
///
/// A row is a name like a path and a function of benchmark::State. The function checks that the contestants agree
/// before it times (agree()), then ends with count_rays(). docs/benchmarks.md says how to read what comes out.
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>

#include <omp.h>
#include <nlohmann/json.hpp>

#include "core/runtime/environment.h"

namespace raypool {

/// Refuses to time a debug build; adds the machine, commit, compiler, flags and OpenMP's variables to the context.
inline bool begin_benchmarks(int argc, char** argv) {
#ifndef NDEBUG
    std::fprintf(stderr, "raypool: a debug build does not benchmark; build in Release\n");
    return false;
#endif
    benchmark::Initialize(&argc, argv);
    const auto add = [](const std::string& key, const nlohmann::json& value) {
        benchmark::AddCustomContext(key, value.is_string() ? value.get<std::string>() : value.dump());
    };
    const nlohmann::json environment = environment_json();
    for (const auto& [key, value] : environment.items()) add(key, value);
    add("openmp_threads", omp_get_max_threads());
    return !benchmark::ReportUnrecognizedArguments(argc, argv);
}

/// Adds a row, timed by the clock on the wall.
template <class Function>
benchmark::internal::Benchmark* add_row(const std::string& name, Function function) {
    return benchmark::RegisterBenchmark(name.c_str(), std::move(function))->UseRealTime();
}

/// Adds a row that times itself with time_prepared().
template <class Function>
benchmark::internal::Benchmark* add_prepared_row(const std::string& name, Function function) {
    return benchmark::RegisterBenchmark(name.c_str(), std::move(function))->UseManualTime();
}

/// Times work() alone, with prepare() before each time, for work that uses up its input. (PauseTiming() asks for the
/// time that the processor spent, a system call: as much as the work of hundreds of rays.)
template <class Prepare, class Work>
void time_prepared(benchmark::State& state, Prepare prepare, Work work) {
    using Clock = std::chrono::steady_clock;
    for (auto _ : state) {
        prepare();
        benchmark::ClobberMemory();
        const Clock::time_point begin = Clock::now();
        work();
        benchmark::ClobberMemory();
        state.SetIterationTime(std::chrono::duration<double>(Clock::now() - begin).count());
    }
}

/// Whether what is compared gives the same; if not, the row is skipped with an error.
inline bool agree(benchmark::State& state, bool is_same, const char* what_differs) {
    if (!is_same) state.SkipWithError(what_differs);
    return is_same;
}

/// The counters of a row: rays (or contributions) that an iteration treats, and the bytes that hold one of them in what
/// the row works on.
inline void count_rays(benchmark::State& state, std::int64_t rays, double bytes) {
    state.counters["rays/s"] =
        benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsIterationInvariantRate);
    state.counters["bytes/ray"] = bytes;
}

}  // namespace raypool
