// The raypool command. The only place that catches: bad input is one line on stderr and exit status 2.

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iterator>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/option_rules.h"
#include "cli/print.h"
#include "cli/processor_check.h"
#include "cluster/agreement.h"
#include "cluster/ranks.h"
#include "core/base/error.h"
#include "core/base/memory.h"
#include "core/base/text.h"
#include "core/math/processor.h"

namespace {

/// Commands that render for long, and that tasks cannot share as they can a render.
bool is_long(std::string_view command) {
    return command == "compare" || command == "advise" || command == "study";
}

/// Commands that a build without RAYPOOL_BUILD_BENCH has not.
bool is_left_out([[maybe_unused]] std::string_view command) {
#ifdef RAYPOOL_HAS_BENCH
    return false;
#else
    return command == "advise" || command == "study" || command == "report";
#endif
}

/// Whoever read the standard output has read enough. As of any other tool, to which SIGPIPE happens, without a word.
constexpr int kReaderIsGone = 128 + SIGPIPE;

int run(int argc, char** argv, raypool::cluster::Ranks& ranks) {
    const auto fail = [&](int status, const std::string& text) {
        return raypool::cluster::fail(ranks, status, raypool::printable(text));
    };
    const auto fail_to_print = [&](bool is_reader_gone) {
        return is_reader_gone && ranks.count() == 1 ? kReaderIsGone : fail(1, "cannot write to the standard output");
    };
    try {
        if (ranks.count() > 1 && (argc < 2 || std::strcmp(argv[1], "render") != 0))
            return fail(2, "several ranks can only run the command render");
        if (ranks.separate_count() > 1 && argc > 1 && is_long(argv[1]))
            return fail(2, fmt::format("{} tasks were started, and each would run {} for itself (SLURM_STEP_NUM_TASKS)",
                                       ranks.separate_count(), argv[1]));
        CLI::App app("Ray pools against recursion on a CPU: one image, two orders of work, measured.", "raypool");
        app.require_subcommand(0, 1);  // a wrong command is then named as an argument that was not expected
        app.set_version_flag("--version", RAYPOOL_VERSION);
        int status = 0;
        raypool::cli::add_render_command(app, ranks, status);
        raypool::cli::add_compare_command(app, status);
        raypool::cli::add_info_command(app, status);
        raypool::cli::add_diff_command(app, status);
        raypool::cli::add_merge_command(app, status);
        raypool::cli::add_scenes_command(app);
#ifdef RAYPOOL_HAS_BENCH
        raypool::cli::add_advise_command(app, status);
        raypool::cli::add_study_command(app, status);
        raypool::cli::add_report_command(app, status);
#endif
        raypool::cli::add_manual_command(app);
        if (argc > 1 && is_left_out(argv[1]))
            return fail(2,
                        fmt::format("this build has no command {}; the presets study and release build it", argv[1]));
        const auto is_meant = [&](const CLI::App* command) { return command->check_name(argv[1]); };
        if (argc > 1 && argv[1][0] != '-' &&
            app.get_subcommands(is_meant).empty())  // or --help beside it would be answered
            return fail(2, fmt::format("there is no command {} (see --help)", argv[1]));
        app.parse_complete_callback([&app] {  // before what a command does
            for (const CLI::App* command : app.get_subcommands()) raypool::cli::check_option_rules(*command);
        });
        try {
            app.parse(argc, argv);
            if (app.get_subcommands().empty()) return fail(2, "a command is required (see --help)");
        } catch (const CLI::ParseError& error) {
            if (error.get_exit_code() != 0) return fail(2, fmt::format("{} (see --help)", error.what()));
            raypool::cluster::agree(ranks, {{"command", "help"}});
            if (ranks.is_first()) app.exit(error);  // --help, --version
        }
        // What was written before the last flush may have failed, too: help is longer than a buffer.
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return fail_to_print(errno == EPIPE);
        return status;
    } catch (const std::system_error& error) {
        return error.code() == std::errc::broken_pipe ? fail_to_print(true) : fail(1, error.what());
    } catch (const raypool::InputError& error) {
        return fail(2, error.what());
    } catch (const std::bad_alloc&) {
        return fail(2,
                    fmt::format("out of memory: {} are available", raypool::bytes_text(raypool::available_memory())));
    } catch (const std::exception& error) {
        return fail(1, error.what());
    }
}

}  // namespace

#ifdef RAYPOOL_CHECKS_PROCESSOR
/// Constants, since they are read before anything is made.
constinit const raypool::cli::NeededInstructionSets raypool::cli::kNeededInstructionSets{
    std::begin(raypool::kInstructionSets), std::end(raypool::kInstructionSets)};
#endif

int main(int argc, char** argv) {
    // Writing past a limit or into a closed pipe shall be an error that can be reported, not a signal that kills.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    try {
        return run(argc, argv, *raypool::cluster::join_ranks());
    } catch (const raypool::InputError& error) {
        raypool::cli::print(stderr, "raypool: {}\n", error.what());
        return 2;
    }
}
