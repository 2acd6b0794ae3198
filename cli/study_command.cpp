#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/studies/analysis.h"
#include "bench/studies/registry.h"
#include "bench/studies/runner.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print.h"
#include "cli/progress_bar.h"
#include "cli/status_file.h"
#include "cli/stop_signals.h"
#include "core/base/error.h"

namespace raypool::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kReproduce = "reproduce";
/// They repeat the paper together, in the order of its page.
const std::vector<std::string> kPaperStudies{"load", "schedules", "scaling", "pool", "framebuffer"};
/// They ask what the paper did not, and have a page of their own.
const std::vector<std::string> kBeyondStudies{"scene-size", "traversal", "light", "gpu"};

struct StudyCommand {
    std::string name;
    studies::StudyOptions options;
    std::string seed = "0";
    std::string output;
    std::string status;
    bool is_fresh = false;
    bool is_quiet = false;
};

void list_studies() {
    for (const studies::Study& study : studies::all_studies()) print("{:<14} {}\n", study.name, study.question);
    print(
        "{:<14} All of the paper's experiments, and a page that holds its figures against ours; and one beyond them.\n",
        kReproduce);
}

/// One study, in `folder`.
int run(const studies::Study& study, const fs::path& folder, StudyCommand& command) {
    command.options.folder = folder;
    const std::int64_t runs = studies::run_count(study, command.options);  // refuses options before a folder is made
    const FileLock lock = studies::lock_folder(folder);
    Progress progress;
    bool is_complete = false;
    {
        const StatusFile status(command.status, study.name, "runs", progress, runs);
        const ProgressBar bar(progress, runs, {"runs/s", 1}, command.is_quiet);
        is_complete =
            studies::run_study(study, command.options, folder, {command.is_fresh, &StopSignals::received(), &progress});
    }
    if (!is_complete) {
        print(stderr, "raypool: stopped after {} runs, all of them kept; the same command goes on from there\n",
              progress.paths.load());
        return 128 + StopSignals::received();
    }
    studies::analyse(folder);
    if (!command.is_quiet) print("{}\n", (folder / "summary.md").string());
    return 0;
}

int study(StudyCommand& command) {
#ifndef NDEBUG
    throw InputError("study: a debug build does not time; build in Release");
#endif
    if (command.name.empty()) {
        list_studies();
        return 0;
    }
    command.options.seed = parse_seed(command.seed);
    const StopSignals signals;  // end a study after the case under way; a second one at once
    if (command.options.threads > 0) thread_count(command.options.threads);
    const fs::path folder = command.output.empty() ? fs::path("out") / command.name : fs::path(command.output);
    if (command.name != kReproduce) return run(studies::make_study(command.name), folder, command);
    for (const auto* names : {&kPaperStudies, &kBeyondStudies}) {
        for (const std::string& name : *names) {
            const int status = run(studies::make_study(name), folder / name, command);
            if (status != 0) return status;
        }
    }
    studies::write_reproduction(folder, kPaperStudies, kBeyondStudies);
    if (!command.is_quiet) print("{}\n{}\n", (folder / "summary.md").string(), (folder / "beyond.md").string());
    return 0;
}

}  // namespace

void add_study_command(CLI::App& app, int& status) {
    auto command = std::make_shared<StudyCommand>();
    studies::StudyOptions& options = command->options;
    CLI::App* sub = app.add_subcommand("study", "Run an experiment: data, pictures and what they say, in a folder");
    sub->add_option("name", command->name, "Which; without it, all are listed");
    sub->add_flag("--quick", options.is_quick, "Small images and few repeats: under a minute");
    sub->add_option("--out", command->output, "Folder (default: out/NAME); an interrupted run in it goes on")
        ->check(check_file_name);
    sub->add_flag("--fresh", command->is_fresh, "Begin anew, whatever the folder holds");
    CLI::Option* scene =
        sub->add_option("--scene", options.scene, "Scene file, or the name of a built-in scene (default: the study's)");
    const auto at_least_one = [](std::int64_t most) { return CLI::Range(std::int64_t{1}, most); };
    sub->add_option("--width", options.width, "Image width (default: the study's)")->check(at_least_one(65536));
    sub->add_option("--spp", options.spp, "Samples per pixel (default: the study's)")
        ->check(at_least_one(std::numeric_limits<std::int32_t>::max()));
    sub->add_option("--depth", options.depth, "Most segments of a path (default: the study's)")
        ->check(at_least_one(path_step::kMostBounces));
    sub->add_option("--threads", options.threads, "Most threads (default: the study's)")->check(CLI::Range(1, 4096));
    sub->add_option("--repeats", options.repeats, "Interleaved runs of each case (default: the study's)")
        ->check(CLI::Range(1, 1000));
    sub->add_option("--seed", command->seed, "Seed of all random numbers (default: 0)");
    sub->add_option("--only", options.only,
                    "A regular expression: only cases whose names in data.csv match it, a part of a long study");
    sub->add_option("--status", command->status,
                    "Write how many runs are done and left to this file every two seconds, as JSON")
        ->check(check_file_name);
    sub->add_flag("--quiet", command->is_quiet, "Print nothing");
    sub->callback([command, scene, &status] {
        command->options.is_scene_given = scene->count() > 0;
        status = study(*command);
    });
}

}  // namespace raypool::cli
