// The manual page and the completion of a shell, made of the options themselves, so that they say what there is.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands.h"

namespace raypool::cli {

namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    const std::function<bool(const CLI::App*)> is_listed = [](const CLI::App* command) {
        return !command->get_group().empty();
    };
    return app.get_subcommands(is_listed);
}

/// "-o", "--output": as they are typed.
std::vector<std::string> words_of(const CLI::Option& option) {
    std::vector<std::string> words;
    for (const std::string& name : option.get_snames()) words.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) words.push_back("--" + name);
    return words;
}

/// As troff wants it: a line that begins with a dot or a quote is a request, and a minus is no hyphen.
std::string troff(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '\\') {
            result += "\\e";
        } else if (c == '-') {
            result += "\\-";
        } else {
            result += c;
        }
    }
    return result.starts_with('.') || result.starts_with('\'') ? "\\&" + result : result;
}

void print_options(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        const bool takes_value = option->get_items_expected_max() > 0;
        const std::vector<std::string> words = words_of(*option);
        const std::string name = words.empty() ? option->get_name(true) : fmt::format("{}", fmt::join(words, ", "));
        fmt::print(".TP\n\\fB{}\\fR{}\n{}\n", troff(name), takes_value && !words.empty() ? " \\fIVALUE\\fR" : "",
                   troff(option->get_description()));
    }
}

void print_manual(const CLI::App& app) {
    fmt::print(".TH RAYPOOL 1 \"\" \"raypool {}\" \"User Commands\"\n", RAYPOOL_VERSION);
    fmt::print(".SH NAME\nraypool \\- {}\n", troff(app.get_description()));
    fmt::print(".SH SYNOPSIS\n\\fBraypool\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR...]\n.SH COMMANDS\n");
    for (const CLI::App* command : commands_of(app))
        fmt::print(".TP\n\\fB{}\\fR\n{}\n", troff(command->get_name()), troff(command->get_description()));
    for (const CLI::App* command : commands_of(app)) {
        fmt::print(".SH OPTIONS OF {}\n", troff(command->get_name()));
        print_options(*command);
    }
    fmt::print(
        ".SH EXIT STATUS\n0: done. 1: failed, or differs from what was asked for. 2: the command line or a file makes "
        "no "
        "sense, and nothing was written. 128 and the number of a signal: stopped by it, with a checkpoint that can be "
        "gone on from.\n");
}

/// The words that an option may have: "{a,b}" in what CLI11 calls its type.
std::vector<std::string> values_of(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t begin = type.find('{');
    const std::size_t end = type.find('}');
    if (begin == std::string::npos || end < begin) return {};
    return CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

/// For bash: commands, then options, and behind these the words that they may have, or files.
void print_completion(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
    fmt::print("_raypool() {{\n    local word=${{COMP_WORDS[COMP_CWORD]}} words=\n");
    fmt::print("    case \"$COMP_CWORD ${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD - 1]}}\" in\n");
    fmt::print("    1\\ *) words=\"{} --help --version\" ;;\n", fmt::join(names, " "));
    for (const CLI::App* command : commands_of(app)) {
        std::vector<std::string> all;
        for (const CLI::Option* option : command->get_options()) {
            const std::vector<std::string> words = words_of(*option);
            all.insert(all.end(), words.begin(), words.end());
            for (const std::string& word : words)
                if (const std::vector<std::string> values = values_of(*option); !values.empty())
                    fmt::print("    *\\ {}\\ {}) words=\"{}\" ;;\n", command->get_name(), word, fmt::join(values, " "));
        }
        fmt::print("    *\\ {}\\ *) [[ $word != -* ]] || words=\"{}\" ;;\n", command->get_name(), fmt::join(all, " "));
    }
    fmt::print("    esac\n    COMPREPLY=($(compgen ${{words:+-W \"$words\"}} -o default -- \"$word\"))\n}}\n");
    fmt::print("complete -o filenames -F _raypool raypool\n");
}

}  // namespace

void add_manual_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("manual", "Print the manual page, or the completion for a shell");
    auto kind = std::make_shared<std::string>("man");
    command->add_option("kind", *kind, "man or bash (default: man)")->check(CLI::IsMember({"man", "bash"}));
    command->callback([kind, &app] { *kind == "man" ? print_manual(app) : print_completion(app); });
}

}  // namespace raypool::cli
