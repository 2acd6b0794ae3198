#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print.h"
#include "core/base/error.h"
#include "core/base/file_lock.h"
#include "core/base/output_file.h"
#include "core/film/checkpoint.h"
#include "core/image/image_file.h"

namespace raypool::cli {

namespace {

struct MergeOptions {
    std::vector<std::string> parts;
    std::string output;
    std::string checkpoint;
    bool is_quiet = false;
};

/// Calls work, and names the file in what it throws.
template <class Work>
void with_name(const std::string& file, Work work) {
    try {
        work();
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", file, error.what()));
    }
}

Checkpoint read_part(const std::string& file) {
    Checkpoint part = read_checkpoint(file);
    if (part.framebuffer.has_halves())
        throw InputError(fmt::format("{}: of an adaptive render, which has no parts", file));
    return part;
}

/// Adds a part to the sum of those before it.
void add(Checkpoint& sum, const Checkpoint& part) {
    check_same_render(part, sum);
    sum.spp = std::max(sum.spp, part.spp);
    for (const SampleRange& range : part.ranges) sum.ranges = with_range(std::move(sum.ranges), range);
    const std::span<std::int64_t> sums = sum.framebuffer.sums();
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (__builtin_add_overflow(sums[i], part.framebuffer.sums()[i], &sums[i]))
            throw InputError("its sums are too large to be a part");
}

int merge(const MergeOptions& options) {
    if (!options.output.empty()) image_format(options.output);
    NamedFiles parts;
    for (const std::string& part : options.parts) parts.emplace_back("a part", part);
    check_distinct({{"--output", options.output}, {"--checkpoint", options.checkpoint}}, parts);
    for (const std::string& file : {options.output, options.checkpoint})
        if (!file.empty()) check_writable(file);
    std::optional<FileLock> lock;
    if (!options.checkpoint.empty()) lock.emplace(options.checkpoint);
    if (std::filesystem::is_regular_file(options.checkpoint))
        throw InputError(fmt::format("{}: is there already; remove it, or name another file", options.checkpoint));
    Checkpoint sum = read_part(options.parts.front());
    for (std::size_t i = 1; i < options.parts.size(); ++i) {
        const Checkpoint part = read_part(options.parts[i]);
        with_name(options.parts[i], [&] { add(sum, part); });
    }

    if (!options.output.empty()) {
        ImageAttributes attributes{{"raypool.hash", sum.framebuffer.hash()}};
        for (const auto& [name, value] : sum.key) attributes["raypool." + name] = value;
        attributes["raypool.spp"] = fmt::to_string(sum.spp);
        write_image(options.output, sum.framebuffer.image(sum.sample_count()), attributes);
    }
    if (!options.checkpoint.empty()) write_checkpoint(options.checkpoint, sum);
    const std::vector<SampleRange> missing = gaps(sum.ranges, sum.spp);
    for (const SampleRange& gap : missing)
        print(stderr, "raypool: samples {} to {} are missing (--samples {}:{})\n", gap.first, gap.end, gap.first,
              gap.end);
    if (!options.is_quiet)
        print("{} of {} samples a pixel\nhash {}\n", sum.sample_count(), sum.spp, sum.framebuffer.hash());
    return missing.empty() ? 0 : 1;
}

}  // namespace

void add_merge_command(CLI::App& app, int& status) {
    auto options = std::make_shared<MergeOptions>();
    CLI::App* command = app.add_subcommand("merge", "Add up parts of a render, exactly; exit 1 if samples are missing");
    command->add_option("parts", options->parts, "Files that `render --samples A:B --checkpoint FILE` wrote")
        ->required();
    command->add_option("-o,--output", options->output, "Image file: .png (sRGB), .exr or .pfm (linear)")
        ->check(check_file_name);
    command->add_option("--checkpoint", options->checkpoint, "Write the sum as a part, too")->check(check_file_name);
    command->add_flag("--quiet", options->is_quiet, "Print nothing");
    command->callback([options, &status] { status = merge(*options); });
}

}  // namespace raypool::cli
