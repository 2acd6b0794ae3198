#include "bench/studies/run_data.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/output_file.h"

namespace raypool::studies {

RunData::RunData(const std::filesystem::path& folder, std::vector<Column> columns, const std::vector<Case>& cases)
    : path_(folder / "data.csv"), table_(std::move(columns)) {
    for (const Case& c : cases)
        RAYPOOL_CHECK(cases_.try_emplace(c.id, c).second, "the cases of a study have ids of their own");
}

RunData::~RunData() {
    if (file_ >= 0) ::close(file_);
}

void RunData::load() {
    read_csv(path_, table_.columns(), [this](const Row& row) {
        check_loaded(row);
        keep(row);
    });
}

void RunData::open() {
    const std::string text = csv_header(table_.columns()) + csv_lines(table_.rows());
    write_whole(path_, std::as_bytes(std::span(text)));
    file_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (file_ < 0) fail(errno);
}

void RunData::add(const Case& c, int repeat, const std::vector<Cells>& added) {
    std::vector<Row> rows;
    for (const Cells& cells : added) {
        Row row = row_of(table_.columns(), Cells{{"case", c.id}, {"repeat", repeat}} + cells);
        for (std::size_t i = 0; i < row.size(); ++i)
            if (const Column& column = table_.columns()[i]; !fault(row[i], column.type).empty())
                throw std::logic_error(
                    fmt::format("a bug in the study: {} of {} {}", column.name, c.id, fault(row[i], column.type)));
        check_image(row);
        rows.push_back(std::move(row));
    }
    const std::string lines = csv_lines(rows);
    struct stat before {};
    if (::fstat(file_, &before) != 0) fail(errno);
    errno = ENOSPC;  // of a write that is short
    if (::write(file_, lines.data(), lines.size()) != static_cast<ssize_t>(lines.size())) {
        const int error = errno;
        static_cast<void>(!::ftruncate(file_, before.st_size));  // a part would pass for the whole
        fail(error);
    }
    for (const Row& row : rows) keep(row);
}

void RunData::check_image(const Row& row) {
    const std::string& image = cases_.at(row[0].get<std::string>()).image;
    if (image.empty() || row[table_.index("hash")].is_null()) return;
    const auto hash = row[table_.index("hash")].get<std::string>();
    const auto [expected, is_first] = hashes_.try_emplace(image, hash);
    if (!is_first && expected->second != hash)
        throw WrongImage(fmt::format("{}: the image has hash {}, that of others is {}", row[0].get<std::string>(), hash,
                                     expected->second));
}

void RunData::check_loaded(const Row& row) {
    if (row[0].is_null() || row[1].is_null()) throw InputError("has no case or no repeat");
    const auto id = row[0].get<std::string>();
    const auto found = cases_.find(id);
    if (found == cases_.end()) throw InputError(fmt::format("case {} is none of this study", id));
    const auto repeat = row[1].get<std::uint64_t>();
    const int repeats = found->second.repeats;
    if (repeat >= static_cast<std::uint64_t>(repeats))
        throw InputError(fmt::format("repeat {} of {}, which has {}", repeat, id, repeats));
    // Rows of one repeat follow each other.
    const std::vector<Row>& rows = table_.rows();
    const auto is_of_it = [&row](const Row& other) { return other[0] == row[0] && other[1] == row[1]; };
    const auto block = std::find_if_not(rows.rbegin(), rows.rend(), is_of_it);
    const bool is_there =
        block == rows.rbegin() ? has(id, static_cast<int>(repeat)) : std::find(rows.rbegin(), block, row) != block;
    if (is_there) throw InputError(fmt::format("repeat {} of {} is there already", repeat, id));
    try {
        check_image(row);
    } catch (const WrongImage& error) {
        throw InputError(error.what());
    }
}

void RunData::keep(const Row& row) {
    table_.add(row);
    done_.emplace(row[0].get<std::string>(), row[1].get<int>());
}

void RunData::fail(int error) const {
    throw InputError(fmt::format("{}: cannot write: {}", path_.string(), std::generic_category().message(error)));
}

}  // namespace raypool::studies
