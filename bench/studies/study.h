/// What a study is: cases to run, and the table that they fill.
///
/// A study owns the question and nothing else: runner.h interleaves the repeats, checks the images, keeps the data and
/// resumes an interrupted run. To add a study, derive from Study in a file of its own and list it in registry.cpp. What
/// the table says is Python's: a module of the same name in scripts/analysis/ reads the rows, judges and draws them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/studies/table.h"

namespace raypool::studies {

/// What a user may set; 0 means the study's own choice.
struct StudyOptions {
    bool is_quick = false;  ///< under a minute, with smaller images and fewer repeats
    std::string scene = "paper";
    bool is_scene_given = false;  ///< studies that look at several scenes then keep to that one
    std::int64_t width = 0;
    std::int64_t spp = 0;
    std::int64_t depth = 0;
    int threads = 0;  ///< the most threads that are run, or whose load is counted
    int repeats = 0;
    std::uint64_t seed = 0;
    std::filesystem::path folder;  ///< of the run, for what is dear to make; empty: nothing is to be kept
};

/// One thing that is run `repeats` times. The id is unique within the study, and stays the same from run to run, since
/// it is how a resumed study knows what it has.
struct Case {
    std::string id;
    std::string image;  ///< cases of one image must all have the same hash (column "hash", empty where an engine
                        ///< refused to render); empty: no image is made
    int repeats = 1;
    std::function<std::vector<Row>()> run;  ///< one repeat: rows of the study's columns. Seconds, not minutes
};

class Study {
  public:
    Study() = default;
    Study(const Study&) = delete;
    Study& operator=(const Study&) = delete;
    virtual ~Study() = default;

    [[nodiscard]] virtual std::string name() const = 0;
    /// What it answers, in one sentence that ends in a question mark.
    [[nodiscard]] virtual std::string question() const = 0;
    /// Behind "case" and "repeat", which every study has.
    [[nodiscard]] virtual std::vector<Column> columns() const = 0;
    /// Throws InputError for options that it cannot carry out.
    [[nodiscard]] virtual std::vector<Case> cases(const StudyOptions& options) const = 0;
    /// What the analysis must know of this build and machine beside the rows, as "facts" in run.json.
    [[nodiscard]] virtual nlohmann::json facts() const { return nlohmann::json::object(); }
    /// Images that the study renders itself, for its pictures to show; written into the folder of its data.
    virtual void write_images(const std::filesystem::path& /*folder*/, const StudyOptions& /*options*/) const {}
};

/// What the options ask for, or what the study would do by itself.
inline std::int64_t choose(std::int64_t asked, bool is_quick, std::int64_t quick, std::int64_t full) {
    return asked != 0 ? asked : is_quick ? quick : full;
}

}  // namespace raypool::studies
