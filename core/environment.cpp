#include "core/environment.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commit.h"

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
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string operating_system() {
    utsname name{};
    return uname(&name) == 0 ? fmt::format("{} {}", name.sysname, name.release) : "unknown";
}

nlohmann::json openmp_variables() {
    nlohmann::json variables = nlohmann::json::object();
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const char* equals = std::strchr(*entry, '=');
        const std::string name(*entry, equals == nullptr ? std::strlen(*entry) : equals - *entry);
        const bool is_openmp = name.starts_with("OMP_") || name.starts_with("GOMP_") || name.starts_with("KMP_");
        if (is_openmp && equals != nullptr) variables[name] = equals + 1;
    }
    return variables;
}

}  // namespace

nlohmann::json environment_json() {
#ifdef NDEBUG
    const char* build = "release";
#else
    const char* build = "debug";
#endif
    return {{"version", RAYPOOL_VERSION},
            {"commit", RAYPOOL_COMMIT},
            {"compiler", compiler()},
            {"flags", RAYPOOL_FLAGS},
            {"build", build},
            {"cpu", cpu()},
            {"cores", sysconf(_SC_NPROCESSORS_ONLN)},
            {"os", operating_system()},
            {"openmp", openmp_variables()}};
}

}  // namespace raypool
