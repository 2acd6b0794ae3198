#include "bench/studies/report.h"

#include <fmt/format.h>

#include "core/base/text.h"

namespace raypool::studies {

using nlohmann::json;

const char* to_string(Verdict verdict) {
    switch (verdict) {
        case Verdict::Holds:
            return "holds";
        case Verdict::DoesNotHold:
            return "does not hold";
        case Verdict::CannotTell:
            break;
    }
    return "cannot be told here";
}

void add_summary(json& run, const Summary& summary) {
    for (const char* key : {"findings", "pictures", "tables"}) run[key] = json::array();
    for (const Finding& f : summary.findings)
        run["findings"].push_back({{"source", f.source},
                                   {"claim", f.claim},
                                   {"paper", f.paper},
                                   {"ours", f.ours},
                                   {"verdict", to_string(f.verdict)},
                                   {"why", f.why}});
    for (const Picture& p : summary.pictures)
        run["pictures"].push_back({{"name", p.name}, {"title", p.title}, {"caption", p.caption}});
    for (const TextTable& t : summary.tables)
        run["tables"].push_back({{"title", t.title}, {"header", t.header}, {"rows", t.rows}});
    run["notes"] = summary.notes;
}

std::string markdown(const json& header, const json& rows) {
    const auto line = [](const json& cells) {
        std::string text = "|";
        for (const json& cell : cells) text += fmt::format(" {} |", cell.get_ref<const std::string&>());
        return text + "\n";
    };
    std::string text = line(header) + "|";
    for (std::size_t i = 0; i < header.size(); ++i) text += "---|";
    text += "\n";
    for (const json& row : rows) text += line(row);
    return text;
}

std::string machine_line(const json& environment) {
    // A run may be older than the record of what its code could use.
    const json simd = environment.value("simd", json());
    const std::string widest =
        simd.is_object() ? fmt::format(" and code for {}", simd.at("instruction_sets").back().get<std::string>()) : "";
    return fmt::format("{}, {} cores, {}{}, commit {}", environment.at("cpu").get_ref<const std::string&>(),
                       environment.at("cores").get<int>(), environment.at("compiler").get_ref<const std::string&>(),
                       widest, environment.at("commit").get_ref<const std::string&>());
}

std::string summary_page(const json& run) {
    const auto text_of = [](const json& object, const char* key) { return object.at(key).get<std::string>(); };
    std::string page = fmt::format("# {}\n\n{}\n\n", text_of(run, "study"), text_of(run, "question"));

    for (const json& picture : run.at("pictures"))
        page += fmt::format("![{}]({}.png)\n\n{}\n\n", text_of(picture, "title"), text_of(picture, "name"),
                            text_of(picture, "caption"));
    if (!run.at("findings").empty()) {
        json rows = json::array();
        for (const json& f : run.at("findings")) {
            const std::string why = text_of(f, "why");
            rows.push_back({text_of(f, "source"), text_of(f, "claim"), text_of(f, "paper"), text_of(f, "ours"),
                            "**" + text_of(f, "verdict") + "**" + (why.empty() ? "" : ": " + why)});
        }
        page += markdown({"paper", "claim", "its figures", "ours", "verdict"}, rows) + "\n";
    }
    for (const json& table : run.at("tables"))
        page += fmt::format("## {}\n\n{}\n", text_of(table, "title"), markdown(table.at("header"), table.at("rows")));
    for (const json& note : run.at("notes")) page += "- " + note.get<std::string>() + "\n";

    const json& options = run.at("options");
    std::string command =
        fmt::format("raypool study {}{}", text_of(run, "study"), options.at("quick").get<bool>() ? " --quick" : "");
    for (const char* key : {"width", "spp", "depth", "threads", "repeats", "seed"})
        if (options.at(key) != 0) command += fmt::format(" --{} {}", key, options.at(key).dump());
    if (options.contains("scene_given") || text_of(options, "scene") != "paper")
        command += " --scene " + shell_word(text_of(options, "scene"));
    page += fmt::format("\n{}. Finished {}; the host took {:.1f} % of the processor time for others.\n",
                        machine_line(run.at("environment")), text_of(run, "finished"),
                        100 * run.at("stolen").get<double>());
    page +=
        fmt::format("Flags and OpenMP variables are in run.json, every row in data.csv. To repeat: `{}`\n", command);
    return page;
}

}  // namespace raypool::studies
