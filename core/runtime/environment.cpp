#include "core/runtime/environment.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commit.h"
#include "core/base/text.h"
#include "core/math/processor.h"
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

/// The processor's name; of an ARM, whose kernel has none, the numbers of who made it and of what it is.
std::string cpu() {
    std::ifstream info("/proc/cpuinfo");
    std::map<std::string, std::string> facts;
    for (std::string line; std::getline(info, line);) {
        const std::size_t name_end = line.find_first_of("\t:");
        const std::size_t colon = line.find(": ");
        if (colon != std::string::npos) facts.emplace(line.substr(0, name_end), valid_utf8(line.substr(colon + 2)));
    }
    if (facts.contains("model name")) return facts["model name"];
    if (facts.contains("CPU part"))
        return fmt::format("ARM, implementer {}, part {}", facts["CPU implementer"], facts["CPU part"]);
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
    return {{std::begin(kInstructionSets), std::end(kInstructionSets)},
            stdx::native_simd<float>::size(),
            stdx::native_simd<double>::size(),
            kTreeWidth<float>,
            kTreeWidth<double>};
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
