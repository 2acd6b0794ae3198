#include <memory>
#include <string>
#include <vector>

#include "bench/studies/analysis.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print.h"

namespace raypool::cli {

namespace {

struct ReportCommand {
    std::vector<std::string> folders;
    std::string output = "out/site";
    bool is_quiet = false;
};

int report(const ReportCommand& command) {
    const int status = studies::write_report(command.folders, command.output);
    if (status == 0 && !command.is_quiet) print("{}/index.html\n", command.output);
    return status;
}

}  // namespace

void add_report_command(CLI::App& app, int& status) {
    auto command = std::make_shared<ReportCommand>();
    CLI::App* sub =
        app.add_subcommand("report", "Pages to look into, of runs of studies, and of two of one side by side");
    sub->add_option("folders", command->folders, "Folders that studies wrote, or that hold such")->required();
    sub->add_option("-o,--output", command->output, "Folder for the pages")
        ->check(check_file_name)
        ->capture_default_str();
    sub->add_flag("--quiet", command->is_quiet, "Print nothing");
    sub->callback([command, &status] { status = report(*command); });
}

}  // namespace raypool::cli
