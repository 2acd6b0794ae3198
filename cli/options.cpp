#include "cli/options.h"

#include <omp.h>
#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/output_file.h"
#include "core/base/thread_limit.h"

namespace raypool::cli {

SampleRange parse_samples(std::string_view text, std::int64_t spp) {
    const std::size_t colon = text.find(':');
    if (colon != std::string_view::npos) {
        const auto first = parse_integer(text.substr(0, colon), 0, spp - 1);
        const auto end = parse_integer(text.substr(colon + 1), 1, spp);
        if (first && end && *first < *end) return {*first, *end};
    }
    throw InputError(fmt::format("--samples: must be A:B with 0 <= A < B <= spp ({}), got {}", spp, text));
}

std::uint64_t parse_seed(std::string_view text) {
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
    if (error != std::errc() || end != text.data() + text.size())
        throw InputError(fmt::format("--seed: must be a whole number in [0, 2^64), got {}", text));
    return seed;
}

int thread_count(int asked) {
    const int count = asked == 0 ? omp_get_max_threads() : asked;
    check_thread_count(count, asked == 0 ? "OMP_NUM_THREADS" : "--threads");
    omp_set_num_threads(count);
    return count;
}

namespace {

/// What is the same for all names of a file that is there or could be; empty for a device, and for what is refused
/// elsewhere.
std::string identity(const std::string& name) {
    struct stat status {};
    if (::stat(name.c_str(), &status) == 0)
        return S_ISREG(status.st_mode) ? fmt::format("{} {}", status.st_dev, status.st_ino) : "";
    std::error_code error;
    const std::filesystem::path path = weakly_canonical(absolute(final_file(name), error), error);
    return error ? "" : path.string();
}

}  // namespace

void check_distinct(const NamedFiles& outputs, const NamedFiles& inputs) {
    std::map<std::string, std::string> option_of;
    for (const auto& [option, file] : inputs)
        if (std::error_code error; std::filesystem::exists(file, error)) option_of.emplace(identity(file), option);
    for (const auto& [option, file] : outputs) {
        const std::string id = file.empty() ? "" : identity(file);
        if (id.empty()) continue;
        const auto [other, is_new] = option_of.emplace(id, option);
        if (!is_new) throw InputError(fmt::format("{}: {} is also the file of {}", option, file, other->second));
    }
}

std::function<std::string(const std::string&)> check_within(double least, double most) {
    return [least, most](const std::string& text) {
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool is_number = error == std::errc() && end == text.data() + text.size();
        if (is_number && value >= least && value <= most) return std::string();
        return fmt::format("must be a number in [{:g}, {:g}], got {}", least, most, text);
    };
}

std::string check_file_name(const std::string& text) {
    return text.empty() ? "must name a file" : "";
}

}  // namespace raypool::cli
