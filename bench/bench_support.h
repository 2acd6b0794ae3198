/// What every benchmark shares: a debug build refuses, and where a figure comes from goes into the JSON beside it.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/environment.h"

namespace raypool {

/// Refuses to time a debug build; adds the commit, compiler and flags to the benchmark's context.
inline bool begin_benchmarks(int argc, char** argv) {
#ifndef NDEBUG
    std::fprintf(stderr, "raypool: a debug build does not benchmark; build in Release\n");
    return false;
#endif
    benchmark::Initialize(&argc, argv);
    const nlohmann::json environment = environment_json();
    for (const char* key : {"version", "commit", "compiler", "flags", "cpu", "os"})
        benchmark::AddCustomContext(key, environment[key].get<std::string>());
    return !benchmark::ReportUnrecognizedArguments(argc, argv);
}

}  // namespace raypool
