#include "core/runtime/environment.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commit.h"
#include "core/base/text.h"
#include "core/math/real.h"
#include "core/shading/compiled_scene.h"

extern char** environ;

namespace raypool {

namespace {

std::string compiler() {
#ifdef __clang__
    return "clang " __clang_version__;
#else
    return "gcc " __VERSION__;
#endif
}

std::string cpu() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return valid_utf8(line.substr(colon + 2));
    }
    return "unknown";
}

std::string operating_system() {
    utsname name{};
    return uname(&name) == 0 ? valid_utf8(fmt::format("{} {}", name.sysname, name.release)) : "unknown";
}

nlohmann::json openmp_variables() {
    nlohmann::json variables = nlohmann::json::object();
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const char* equals = std::strchr(*entry, '=');
        const std::string name(*entry, equals == nullptr ? std::strlen(*entry) : equals - *entry);
        const bool is_openmp = name.starts_with("OMP_") || name.starts_with("GOMP_") || name.starts_with("KMP_");
        if (is_openmp && equals != nullptr) variables[valid_utf8(name)] = valid_utf8(equals + 1);
    }
    return variables;
}

}  // namespace

CodeWidths code_widths() {
    CodeWidths widths{
        {}, stdx::native_simd<float>::size(), stdx::native_simd<double>::size(), kTreeWidth<float>, kTreeWidth<double>};
    std::vector<std::string>& sets = widths.instruction_sets;
#ifdef __SSE2__
    sets.emplace_back("sse2");
#endif
#ifdef __SSE3__
    sets.emplace_back("sse3");
#endif
#ifdef __SSSE3__
    sets.emplace_back("ssse3");
#endif
#ifdef __SSE4_1__
    sets.emplace_back("sse4.1");
#endif
#ifdef __SSE4_2__
    sets.emplace_back("sse4.2");
#endif
#ifdef __AVX__
    sets.emplace_back("avx");
#endif
#ifdef __F16C__
    sets.emplace_back("f16c");
#endif
#ifdef __FMA__
    sets.emplace_back("fma");
#endif
#ifdef __AVX2__
    sets.emplace_back("avx2");
#endif
#ifdef __AVX512F__
    sets.emplace_back("avx512f");
#endif
#ifdef __AVX512CD__
    sets.emplace_back("avx512cd");
#endif
#ifdef __AVX512BW__
    sets.emplace_back("avx512bw");
#endif
#ifdef __AVX512DQ__
    sets.emplace_back("avx512dq");
#endif
#ifdef __AVX512VL__
    sets.emplace_back("avx512vl");
#endif
    return widths;
}

nlohmann::json environment_json() {
#ifdef NDEBUG
    const char* build = "release";
#else
    const char* build = "debug";
#endif
    const CodeWidths widths = code_widths();
    return {{"version", RAYPOOL_VERSION},
            {"commit", RAYPOOL_COMMIT},
            {"compiler", compiler()},
            {"flags", RAYPOOL_FLAGS},
            {"build", build},
            {"simd",
             {{"instruction_sets", widths.instruction_sets},
              {"stage_lanes", {{"float", widths.float_lanes}, {"double", widths.double_lanes}}},
              {"tree_width", {{"float", widths.float_tree_width}, {"double", widths.double_tree_width}}}}},
            {"cpu", cpu()},
            {"cores", sysconf(_SC_NPROCESSORS_ONLN)},
            {"os", operating_system()},
            {"openmp", openmp_variables()}};
}

}  // namespace raypool
