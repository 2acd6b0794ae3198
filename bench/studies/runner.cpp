#include "bench/studies/runner.h"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <numeric>
#include <regex>
#include <set>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/studies/run_data.h"
#include "core/base/error.h"
#include "core/base/json_file.h"
#include "core/base/text.h"
#include "core/runtime/environment.h"
#include "core/scene/scene_hash.h"
#include "core/scene/scene_reader.h"

namespace raypool::studies {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string now() {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

/// Processor time since boot, in ticks: all, and what the host of a virtual machine gave to others.
struct CpuTime {
    double all = 0;
    double stolen = 0;
};
CpuTime cpu_time() {
    std::ifstream file("/proc/stat");
    std::string name;
    file >> name;
    CpuTime time;
    for (int i = 0; i < 8 && file >> time.stolen; ++i) time.all += time.stolen;  // the eighth is what was stolen
    return time;
}

/// What fixes the meaning of every row: a run is resumed only where all of this is the same.
json identity(const Study& study, const StudyOptions& options, const std::vector<Case>& cases,
              const std::vector<Column>& columns) {
    json plan = json::array();
    for (const Case& c : cases) plan.push_back({{"case", c.id}, {"image", c.image}, {"repeats", c.repeats}});
    json asked{{"quick", options.is_quick},  {"scene", valid_utf8(options.scene)},
               {"width", options.width},     {"spp", options.spp},
               {"depth", options.depth},     {"threads", options.threads},
               {"repeats", options.repeats}, {"seed", options.seed}};
    if (options.is_scene_given) {
        asked["scene_given"] = true;
        asked["scene_hash"] = scene_hash(load_scene(options.scene));  // a file may change under its name
    }
    if (!options.only.empty()) asked["only"] = valid_utf8(options.only);
    json described = json::array();
    for (const Column& column : columns) described.push_back({{"name", column.name}, {"what", column.what}});
    return {{"study", study.name}, {"question", study.question}, {"options", asked},
            {"plan", plan},        {"columns", described},       {"environment", environment_json()}};
}

std::vector<Case> asked_cases(const Study& study, const StudyOptions& options) {
    std::vector<Case> cases = study.cases(options);
    if (options.only.empty()) return cases;
    try {
        const std::regex pattern(options.only);
        std::erase_if(cases, [&](const Case& c) { return !std::regex_search(c.id, pattern); });
    } catch (const std::regex_error& error) {
        throw InputError(fmt::format("--only: '{}' is no regular expression: {}", options.only, error.what()));
    }
    if (cases.empty())
        throw InputError(fmt::format("--only: study {} has no case like '{}'", study.name, options.only));
    return cases;
}

/// The keys that one has and the other has not, or has with another value.
std::vector<std::string> differing_keys(const json& a, const json& b) {
    std::set<std::string> keys;
    for (const json& side : {a, b})
        for (const auto& [key, value] : side.items())
            if (!a.contains(key) || !b.contains(key) || a.at(key) != b.at(key)) keys.insert(key);
    return {keys.begin(), keys.end()};
}

void check_same(const json& found, const json& wanted, const std::string& key, const fs::path& folder) {
    const json was = found.value(key, json());
    if (was == wanted.at(key)) return;
    const std::string keys = was.is_object() && wanted.at(key).is_object()
                                 ? fmt::format(": {}", fmt::join(differing_keys(was, wanted.at(key)), ", "))
                                 : "";
    throw InputError(fmt::format("{}: holds another run (it differs in {}{}); go on with the same, or add --fresh",
                                 folder.string(), key, keys));
}

std::vector<Column> all_columns(const Study& study) {
    std::vector<Column> columns{{"case", ColumnType::Text, "what was run"},
                                {"repeat", ColumnType::Count, "which time; repeats of one number ran side by side"}};
    columns.insert(columns.end(), study.columns.begin(), study.columns.end());
    return columns;
}

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw InputError(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));
}

json read_run(const fs::path& folder) {
    std::ifstream file(folder / "run.json");
    json run = json::parse(file, nullptr, false);
    if (run.is_discarded() || !run.is_object() || (run.contains("started") && !run["started"].is_array()))
        throw InputError(
            fmt::format("{}: not a run of a study; add --fresh to write over it", (folder / "run.json").string()));
    return run;
}

}  // namespace

std::vector<std::size_t> turn_order(std::size_t count, std::size_t turn) {
    std::size_t stride = turn + 1;
    while (std::gcd(stride, count) != 1) ++stride;
    std::vector<std::size_t> order(count);
    for (std::size_t i = 0; i < count; ++i) order[i] = (turn + i * stride) % count;
    return order;
}

std::int64_t run_count(const Study& study, const StudyOptions& options) {
    std::int64_t count = 0;
    for (const Case& c : asked_cases(study, options)) count += c.repeats;
    return count;
}

FileLock lock_folder(const fs::path& folder) {
    make_folder(folder);
    return FileLock(folder / "data.csv");
}

bool run_study(const Study& study, const StudyOptions& options, const fs::path& folder, const RunControl& control) {
    const std::vector<Case> cases = asked_cases(study, options);
    const std::vector<Column> columns = all_columns(study);
    json run = identity(study, options, cases, columns);

    // Begin, or go on.
    make_folder(folder);
    RunData data(folder, columns, cases);
    if (!control.is_fresh && fs::exists(folder / "run.json")) {
        const json found = read_run(folder);
        for (const char* key : {"study", "question", "options", "plan", "columns"}) check_same(found, run, key, folder);
        data.load();
        // A complete run is only analysed anew, by whatever build: its figures keep the origin that they have.
        if (data.run_count() == run_count(study, options) && found.contains("environment"))
            run["environment"] = found["environment"];
        check_same(found, run, "environment", folder);
        for (const char* key : {"started", "finished", "stolen", "facts"})
            if (found.contains(key)) run[key] = found[key];
    }
    data.open();  // before run.json says that what is in it belongs to this run
    std::error_code ignored;
    if (control.is_fresh) fs::remove(folder / "summary.md", ignored);
    const bool was_complete = data.run_count() == run_count(study, options) && run.contains("finished");
    if (!was_complete) {
        run["started"].push_back(now());
        write_json(folder / "run.json", run);
    }
    if (control.progress != nullptr) control.progress->before = control.progress->paths = data.run_count();

    // Repeats outermost.
    int repeats = 0;
    for (const Case& c : cases) repeats = std::max(repeats, c.repeats);
    const CpuTime before = cpu_time();
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (const std::size_t i : turn_order(cases.size(), static_cast<std::size_t>(repeat))) {
            const Case& c = cases[i];
            if (repeat >= c.repeats || data.has(c.id, repeat)) continue;
            if (control.stop_signal != nullptr && *control.stop_signal != 0) return false;
            data.add(c, repeat, c.run());
            if (control.progress != nullptr) ++control.progress->paths;
        }
    }

    if (!was_complete) {
        const CpuTime after = cpu_time();
        run["finished"] = now();
        run["stolen"] = (after.stolen - before.stolen) / std::max(1.0, after.all - before.all);
    }
    if (!run.contains("facts")) run["facts"] = study.facts();
    if (study.write_images) study.write_images(folder, options);
    write_json(folder / "run.json", run);
    return true;
}

}  // namespace raypool::studies
