#include "bench/studies/analysis.h"

#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/process.h"

namespace raypool::studies {

namespace {

namespace fs = std::filesystem;

constexpr int kPackageIsMissing = 3;  // scripts/analysis/__main__.py

/// Returns the exit status; kPackageIsMissing also where there is no Python.
int call_analysis(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {kPython, "-B", own_script(RAYPOOL_INSTALLED_ANALYSIS, RAYPOOL_SOURCE_ANALYSIS)});
    return fs::exists(kPython) ? run_process(arguments) : kPackageIsMissing;
}

void run_analysis(const fs::path& folder, std::vector<std::string> arguments) {
    const int status = call_analysis(std::move(arguments));
    if (status == 0) return;
    throw std::runtime_error(
        fmt::format("{}: the data are complete, but {}; the same command goes on from there", folder.string(),
                    status == kPackageIsMissing ? "their analysis needs the packages python3 and python3-matplotlib"
                                                : fmt::format("their analysis failed (exit status {})", status)));
}

}  // namespace

void analyse(const fs::path& folder) {
    run_analysis(folder, {"study", folder.string()});
}

void write_reproduction(const fs::path& folder, const std::vector<std::string>& of_paper,
                        const std::vector<std::string>& beyond) {
    std::vector<std::string> arguments{"reproduce", folder.string()};
    arguments.insert(arguments.end(), of_paper.begin(), of_paper.end());
    arguments.emplace_back("--beyond");
    arguments.insert(arguments.end(), beyond.begin(), beyond.end());
    run_analysis(folder, std::move(arguments));
}

int write_report(const std::vector<std::string>& folders, const std::string& site) {
    std::vector<std::string> arguments{"report", "--", site};
    arguments.insert(arguments.end(), folders.begin(), folders.end());
    const int status = call_analysis(std::move(arguments));
    if (status == kPackageIsMissing)
        throw std::runtime_error("a report needs the packages python3, python3-matplotlib and python3-jinja2");
    return status;
}

}  // namespace raypool::studies
