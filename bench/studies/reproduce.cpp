#include "bench/studies/reproduce.h"

#include <fstream>
#include <span>

#include <fmt/format.h>

#include "bench/studies/report.h"
#include "core/base/error.h"
#include "core/base/output_file.h"

namespace raypool::studies {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A table or figure of the paper, in its order, and what it shows.
struct PaperItem {
    const char* source;
    const char* what;
};
constexpr PaperItem kItems[] = {
    {"Table 1, Figure 7", "speedup of the basic version up to 64 threads"},
    {"Table 2, Figure 12", "efficiency of static,1 by image width"},
    {"Figure 5", "work of each thread by schedule"},
    {"Figure 8", "the operation pool against plain recursion"},
    {"Figure 9", "time of static,1 against the default schedule"},
    {"Figure 10", "time of single pixels against lines"},
    {"Figure 11", "interleaved framebuffer against three planes"},
    {"CPU against GPU", "time by image width"},
};

json read_finished(const fs::path& folder) {
    std::ifstream file(folder / "run.json");
    json run = json::parse(file, nullptr, false);
    if (run.is_discarded() || !run.contains("finished"))
        throw InputError(fmt::format("{}: holds no finished run", folder.string()));
    return run;
}

json row(const std::string& item, const json& finding, const std::string& study) {
    const std::string why = finding.at("why");
    return {item,
            finding.at("claim"),
            finding.at("paper"),
            finding.at("ours"),
            "**" + finding.at("verdict").get<std::string>() + "**" + (why.empty() ? "" : ": " + why),
            study.empty() ? "" : fmt::format("[{0}]({0}/summary.md)", study)};
}

}  // namespace

std::vector<std::string> paper_studies() {
    return {"load", "schedules", "scaling", "pool", "framebuffer"};
}

void write_reproduction(const fs::path& folder) {
    std::string page =
        "# The paper's experiments, repeated\n\nHe, Song and Zong, \"Parallel Ray Tracing with OpenMP\": "
        "what the paper reports, what this machine shows, and whether the claim holds here.\n\n";
    std::vector<json> runs;
    for (const std::string& name : paper_studies()) runs.push_back(read_finished(folder / name));

    json rows = json::array();
    for (const PaperItem& item : kItems) {
        const std::string label = fmt::format("{}: {}", item.source, item.what);
        const std::size_t before = rows.size();
        for (const json& run : runs)
            for (const json& finding : run.at("findings"))
                if (finding.at("source") == item.source) rows.push_back(row(label, finding, run.at("study")));
        RAYPOOL_CHECK(rows.size() > before, "each table and figure of the paper has a finding");
    }
    page += markdown({"of the paper", "claim", "the paper's figures", "ours", "verdict", "from"}, rows) + "\n";

    for (const json& run : runs) {
        const std::string study = run.at("study");
        page += fmt::format("## {}\n\n{}\n\n", study, run.at("question").get<std::string>());
        for (const json& picture : run.at("pictures"))
            page += fmt::format("![{}]({}/{}.png)\n\n", picture.at("title").get<std::string>(), study,
                                picture.at("name").get<std::string>());
    }
    page += fmt::format("{}.\n", machine_line(runs.front().at("environment")));
    write_whole(folder / "summary.md", std::as_bytes(std::span(page)));
}

}  // namespace raypool::studies
