/// What a study is: cases to run, and the table that they fill.
///
/// A study owns the question and nothing else: runner.h interleaves the repeats, checks the images, keeps the data and
/// resumes an interrupted run. To add a study, define a function that returns it in a file of its own, and list that in
/// registry.h and registry.cpp. What the table says is Python's: a module of the same name in scripts/analysis/ reads
/// the rows, judges and draws them.
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
    std::string only;  ///< a regular expression (ECMAScript): cases whose id has no match are left out; empty: none is
    std::filesystem::path folder;  ///< of the run, for what is dear to make; empty: nothing is to be kept
};

/// One thing that is run `repeats` times. The id is unique within the study, and stays the same from run to run, since
/// it is how a resumed study knows what it has.
struct Case {
    std::string id;
    std::string image;  ///< cases of one image must all have the same hash (column "hash", empty where an engine
                        ///< refused to render); empty: no image is made
    int repeats = 1;
    std::function<std::vector<Cells>()> run;  ///< one repeat: rows of the study's columns. Seconds, not minutes
};

struct Study {
    std::string name;
    std::string question;         ///< what it answers, in one sentence that ends in a question mark
    std::vector<Column> columns;  ///< behind "case" and "repeat", which every study has
    /// Throws InputError for options that it cannot carry out.
    std::function<std::vector<Case>(const StudyOptions& options)> cases;
    /// What the analysis must know of this build and machine beside the rows, as "facts" in run.json.
    std::function<nlohmann::json()> facts = [] { return nlohmann::json::object(); };
    /// Writes images for the pictures of the study into the folder of its data; may be empty.
    std::function<void(const std::filesystem::path& folder, const StudyOptions& options)> write_images = {};
};

/// A number that a study takes by itself, in a quick run and in a full one.
struct Usual {
    std::int64_t quick, full;
};
/// What is asked for, or the usual.
inline std::int64_t choose(const StudyOptions& options, std::int64_t asked, const Usual& usual) {
    return asked != 0 ? asked : options.is_quick ? usual.quick : usual.full;
}

}  // namespace raypool::studies
