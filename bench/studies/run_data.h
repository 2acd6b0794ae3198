/// The rows of a study's run, on the disk (data.csv) and in memory.
///
/// Rows are appended as soon as they are known, those of one repeat of a case at once, and never twice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/studies/study.h"

namespace raypool::studies {

/// Cases that must make one image made two. Nothing of the run that showed it is kept.
class WrongImage : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

class RunData {
  public:
    RunData(const std::filesystem::path& folder, std::vector<Column> columns, const std::vector<Case>& cases);
    RunData(const RunData&) = delete;
    RunData& operator=(const RunData&) = delete;
    ~RunData();

    /// Takes over what an interrupted run left behind. Throws InputError, with file and line, for rows that no run of
    /// these cases leaves.
    void load();
    /// Opens the file for add(): what is in memory, and no half line behind it.
    void open();

    [[nodiscard]] bool has(const std::string& id, int repeat) const { return done_.contains({id, repeat}); }
    [[nodiscard]] std::int64_t run_count() const { return static_cast<std::int64_t>(done_.size()); }
    [[nodiscard]] const Table& table() const { return table_; }

    /// The rows of one repeat of a case, all of them or, where that fails, none. Throws WrongImage.
    void add(const Case& c, int repeat, const std::vector<Cells>& rows);

  private:
    /// Throws WrongImage where the row's image is not that of others.
    void check_image(const Row& row);
    void check_loaded(const Row& row);
    void keep(const Row& row);
    [[noreturn]] void fail(int error) const;

    std::filesystem::path path_;
    Table table_;
    std::map<std::string, Case> cases_;          ///< by id
    std::map<std::string, std::string> hashes_;  ///< of each image
    std::set<std::pair<std::string, int>> done_;
    int file_ = -1;
};

}  // namespace raypool::studies
