#include "cli/option_rules.h"

#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "cli/engines.h"
#include "core/base/error.h"

namespace raypool::cli {

namespace {

enum class Rule : std::uint8_t {
    Needs,    ///< nothing comes of the option without the other one
    Excludes  ///< nothing comes of it beside the other one
};

struct OptionRule {
    std::string_view command;
    std::string_view option;
    Rule rule;
    std::string_view other;
    std::string_view value;  ///< of the other option, or several with " or " between; empty: any
    std::string_view why;    ///< may be empty
};

constexpr std::string_view kOwnLoop = "its batches are handed out to whichever thread is free";
constexpr std::string_view kOwnCut = "which has a cut of its own";
constexpr std::string_view kListsOnly = "the studies are only listed then";

constexpr OptionRule kRules[] = {
    {"render", "--pool-scope", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--pool-rays", Rule::Needs, "--engine", "wavefront or gpu", ""},
    {"render", "--pool-rays", Rule::Excludes, "--gpu-form", "mega or mega-regenerate", "these have no pool"},
    {"render", "--gpu-form", Rule::Needs, "--engine", "gpu", ""},
    {"render", "--pool-batch", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--refill", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--stage-width", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--intersect", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--camera", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--sort", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--append", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--accumulator", Rule::Needs, "--engine", "wavefront", ""},
    {"render", "--pool-batch", Rule::Needs, "--pool-scope", "shared", "the pool of a thread is one batch"},
    {"render", "--append", Rule::Needs, "--pool-scope", "shared", "the pool of a thread moves no record"},
    {"render", "--schedule", Rule::Excludes, "--pool-scope", "shared", kOwnLoop},
    {"render", "--grain", Rule::Excludes, "--pool-scope", "shared", kOwnLoop},
    {"render", "--grain", Rule::Excludes, "--schedule", "balanced", kOwnCut},
    {"compare", "--grain", Rule::Excludes, "--schedule", "balanced", kOwnCut},
    {"render", "--intersect", Rule::Excludes, "--stage-width", "scalar", "rays are then taken one by one"},
    {"render", "--samples", Rule::Excludes, "--target-error", "", "which samples a pixel gets is for it to decide"},
    {"render", "--crop", Rule::Excludes, "--pixel", "", "which is one pixel"},
    {"render", "--crop", Rule::Excludes, "--target-error", "", "which is of a whole image"},
    {"render", "--crop", Rule::Excludes, "--checkpoint", "", "whose samples are of a whole image"},
    {"render", "--pixel", Rule::Excludes, "--target-error", "", "which is of a whole image"},
    {"render", "--pixel", Rule::Excludes, "--checkpoint", "", "whose samples are of a whole image"},
    {"render", "--pixel", Rule::Excludes, "--split-depth", "", "the paths that are printed follow one branch"},
    {"render", "--pixel", Rule::Excludes, "--precision", "double", "the paths that are printed are in float"},
    {"render", "--pixel", Rule::Excludes, "--quiet", "", "which prints nothing"},
    {"render", "--aovs", Rule::Excludes, "--checkpoint", "", "whose sums do not tell variance"},
    {"render", "--every", Rule::Needs, "--checkpoint", "", ""},
    {"render", "--resume", Rule::Needs, "--checkpoint", "", "that is the file to go on from"},
    {"render", "--cost", Rule::Needs, "--cost-image", "", ""},
    {"compare", "--repeats", Rule::Excludes, "--check", "", "each engine then runs once"},
    {"advise", "--target-error", Rule::Excludes, "--target-time", "", "one of them is what is asked for"},
    {"study", "--quick", Rule::Needs, "name", "", kListsOnly},
    {"study", "--out", Rule::Needs, "name", "", kListsOnly},
    {"study", "--fresh", Rule::Needs, "name", "", kListsOnly},
    {"study", "--scene", Rule::Needs, "name", "", kListsOnly},
    {"study", "--width", Rule::Needs, "name", "", kListsOnly},
    {"study", "--spp", Rule::Needs, "name", "", kListsOnly},
    {"study", "--depth", Rule::Needs, "name", "", kListsOnly},
    {"study", "--threads", Rule::Needs, "name", "", kListsOnly},
    {"study", "--repeats", Rule::Needs, "name", "", kListsOnly},
    {"study", "--seed", Rule::Needs, "name", "", kListsOnly},
    {"study", "--quiet", Rule::Needs, "name", "", kListsOnly},
    {"study", "--status", Rule::Needs, "name", "", kListsOnly},
    {"study", "--only", Rule::Needs, "name", "", kListsOnly},
    {"study", "--scene", Rule::Excludes, "name", "stability", "its cases are scenes of their own"},
    {"study", "--scene", Rule::Excludes, "name", "scene-size", "its scenes are generated"},
    {"study", "--scene", Rule::Excludes, "name", "traversal", "its scenes are generated"},
    {"study", "--scene", Rule::Excludes, "name", "build", "its scenes are generated"},
    {"study", "--depth", Rule::Excludes, "name", "adaptive", "it renders at depth 50"},
    {"study", "--depth", Rule::Excludes, "name", "traversal", "its rays are those of four bounces"},
    {"study", "--depth", Rule::Excludes, "name", "build", "its rays are those of four bounces"},
    {"study", "--threads", Rule::Excludes, "name", "ranks", "its ranks have one thread each"},
    {"study", "--threads", Rule::Excludes, "name", "traversal", "it traces in one"},
};

bool is_one_of(std::string_view value, std::string_view values) {
    constexpr std::string_view kOr = " or ";
    for (;;) {
        const std::size_t end = values.find(kOr);
        if (values.substr(0, end) == value) return true;
        if (end == std::string_view::npos) return false;
        values.remove_prefix(end + kOr.size());
    }
}

bool is_given(const CLI::App& command, std::string_view option, std::string_view values) {
    if (option == "--engine") return is_one_of(engine_in_effect(command), values);
    const CLI::Option& found = *command.get_option(std::string(option));
    return found.count() > 0 && (values.empty() || is_one_of(found.results().front(), values));
}

}  // namespace

std::string engine_in_effect(const CLI::App& render_command) {
    const CLI::Option& engine = *render_command.get_option("--engine");
    if (engine.count() > 0) return engine.results().front();
    return engines().preferred(render_command.get_option("--cost-image")->count() > 0).name;
}

void check_option_rules(const CLI::App& command) {
    for (const OptionRule& rule : kRules) {
        if (rule.command != command.get_name() || !is_given(command, rule.option, "")) continue;
        if (is_given(command, rule.other, rule.value) == (rule.rule == Rule::Needs)) continue;
        throw InputError(
            fmt::format("{}: does nothing {} {}{}{}{}{}", rule.option, rule.rule == Rule::Needs ? "without" : "beside",
                        rule.other, rule.value.empty() ? "" : " ", rule.value, rule.why.empty() ? "" : ": ", rule.why));
    }
}

}  // namespace raypool::cli
