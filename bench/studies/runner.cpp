#include "bench/studies/runner.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "bench/studies/report.h"
#include "core/environment.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/output_file.h"
#include "core/text.h"

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

void write_text(const fs::path& path, const std::string& text) {
    write_whole(path, std::as_bytes(std::span(text)));
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
    if (options.is_scene_given) asked["scene_given"] = true;
    json described = json::array();
    for (const Column& column : columns) described.push_back({{"name", column.name}, {"what", column.what}});
    return {{"study", study.name()}, {"question", study.question()}, {"options", asked},
            {"plan", plan},          {"columns", described},         {"environment", environment_json()}};
}

/// Names the part in which two runs differ.
void check_same_run(const json& found, const json& wanted, const fs::path& folder) {
    for (const auto& [key, value] : wanted.items()) {
        if (found.value(key, json()) == value) continue;
        throw InputError(fmt::format("{}: holds another run ({} differs); go on with the same, or add --fresh",
                                     folder.string(), key));
    }
}

/// The data of a folder, on the disk and in memory.
class Data {
  public:
    Data(fs::path folder, std::vector<Column> columns, const std::vector<Case>& cases)
        : path_(std::move(folder) / "data.csv"), table_(std::move(columns)) {
        for (const Case& c : cases)
            RAYPOOL_CHECK(image_.try_emplace(c.id, c.image).second, "the cases of a study have ids of their own");
    }

    /// Takes over what an interrupted run left behind.
    void load() {
        const Table found = read_csv(path_, table_.columns());
        for (const Row& row : found.rows()) keep(row);
    }
    /// Opens the file for add(): what is in memory, and no half line behind it.
    void open() {
        write_text(path_, csv_header(table_.columns()) + csv_lines(table_.rows()));
        file_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
        if (file_ < 0) fail();
    }
    Data(const Data&) = delete;
    Data& operator=(const Data&) = delete;
    ~Data() {
        if (file_ >= 0) ::close(file_);
    }

    [[nodiscard]] bool has(const std::string& id, int repeat) const { return done_.contains({id, repeat}); }
    [[nodiscard]] std::int64_t run_count() const { return static_cast<std::int64_t>(done_.size()); }
    [[nodiscard]] const Table& table() const { return table_; }

    /// Rows of one repeat of a case: in one write, so that a killed process leaves all of them or none.
    void add(const Case& c, int repeat, std::vector<Row> rows) {
        for (Row& row : rows) row.insert(row.begin(), {c.id, repeat});
        for (const Row& row : rows) keep(row);
        const std::string lines = csv_lines(rows);
        if (::write(file_, lines.data(), lines.size()) != static_cast<ssize_t>(lines.size())) fail();
    }

  private:
    void keep(const Row& row) {
        const auto id = row[0].get<std::string>();
        const std::string& image = image_[id];
        if (!image.empty() && !row[table_.index("hash")].is_null()) {
            const auto hash = row[table_.index("hash")].get<std::string>();
            const auto [expected, is_first] = hashes_.try_emplace(image, hash);
            if (!is_first && expected->second != hash)
                throw WrongImage(
                    fmt::format("{}: the image has hash {}, that of others is {}", id, hash, expected->second));
        }
        table_.add(row);
        done_.emplace(id, row[1].get<int>());
    }
    [[noreturn]] void fail() const {
        throw InputError(fmt::format("{}: cannot write: {}", path_.string(), std::strerror(errno)));
    }

    fs::path path_;
    Table table_;
    std::map<std::string, std::string> image_;
    std::map<std::string, std::string> hashes_;  ///< of each image
    std::set<std::pair<std::string, int>> done_;
    int file_ = -1;
};

std::vector<Column> all_columns(const Study& study) {
    std::vector<Column> columns{{"case", ColumnType::Text, "what was run"},
                                {"repeat", ColumnType::Count, "which time; repeats of one number ran side by side"}};
    const std::vector<Column> own = study.columns();
    columns.insert(columns.end(), own.begin(), own.end());
    return columns;
}

json read_run(const fs::path& folder) {
    std::ifstream file(folder / "run.json");
    json run = json::parse(file, nullptr, false);
    if (run.is_discarded() || !run.is_object())
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
    for (const Case& c : study.cases(options)) count += c.repeats;
    return count;
}

bool run_study(const Study& study, const StudyOptions& options, const fs::path& folder, const RunControl& control) {
    const std::vector<Case> cases = study.cases(options);
    const std::vector<Column> columns = all_columns(study);
    json run = identity(study, options, cases, columns);

    // Begin, or go on.
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw InputError(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));
    Data data(folder, columns, cases);
    if (!control.is_fresh && fs::exists(folder / "run.json")) {
        const json found = read_run(folder);
        data.load();
        // A complete run is only summarised anew, by whatever build: its figures keep the origin that they have.
        if (data.run_count() == run_count(study, options) && found.contains("environment"))
            run["environment"] = found["environment"];
        check_same_run(found, run, folder);
        for (const char* key : {"started", "finished", "stolen"})
            if (found.contains(key)) run[key] = found[key];
    }
    data.open();  // before run.json says that what is in it belongs to this run
    if (control.is_fresh) fs::remove(folder / "summary.md", error);
    const bool was_complete = data.run_count() == run_count(study, options);
    if (!was_complete) {
        run["started"].push_back(now());
        write_json(folder / "run.json", run);
    }
    if (control.progress != nullptr) control.progress->paths = data.run_count();

    // Repeats outermost.
    int repeats = 0;
    for (const Case& c : cases) repeats = std::max(repeats, c.repeats);
    const CpuTime before = cpu_time();
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (const std::size_t i : turn_order(cases.size(), static_cast<std::size_t>(repeat))) {
            const Case& c = cases[i];
            if (repeat >= c.repeats || data.has(c.id, repeat)) continue;
            if (control.is_stopped != nullptr && *control.is_stopped) return false;
            data.add(c, repeat, c.run());
            if (control.progress != nullptr) ++control.progress->paths;
        }
    }

    // What came out.
    if (!was_complete) {
        const CpuTime after = cpu_time();
        run["finished"] = now();
        run["stolen"] = (after.stolen - before.stolen) / std::max(1.0, after.all - before.all);
    }
    const Summary summary = study.summarise(data.table(), options);
    add_summary(run, summary);
    study.write_images(folder, options);
    write_text(folder / "summary.md", summary_page(run));
    write_json(folder / "run.json", run);
    return true;
}

}  // namespace raypool::studies
