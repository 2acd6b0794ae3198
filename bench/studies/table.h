/// The table of a study: rows of typed columns, read from and written as CSV.
///
/// CSV after RFC 4180: a header of column names, texts quoted where they must be. Numbers are finite, and written so
/// that reading them gives the same number; an empty cell is a value that does not exist.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace raypool::studies {

enum class ColumnType : std::uint8_t {
    Text,
    Count,   ///< a whole number, not negative
    Real,    ///< a number, not negative: a time, a rate, an error
    Signed,  ///< a number: a difference, a bias
};

struct Column {
    std::string name;
    ColumnType type;
    std::string what;  ///< meaning and unit, for readers of the data
};

/// A text, a number or null, as the columns say.
using Value = nlohmann::json;
using Row = std::vector<Value>;

inline Value or_null(const std::optional<std::int64_t>& count) {
    return count ? Value(*count) : Value(nullptr);
}

/// A row by the names of its columns; those that it does not name are empty.
using Cells = std::vector<std::pair<std::string, Value>>;
/// More cells of the same row.
Cells operator+(Cells cells, const Cells& more);
/// A name that no column has is a bug.
Row row_of(const std::vector<Column>& columns, const Cells& cells);

class Table {
  public:
    explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

    [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
    /// A column that does not exist is a bug.
    [[nodiscard]] std::size_t index(std::string_view column) const;

    /// A row of a wrong length is a bug.
    void add(Row row);

  private:
    std::vector<Column> columns_;
    std::vector<Row> rows_;
};

/// What is wrong with a value in such a column, "is nan"; empty where nothing is.
std::string fault(const Value& value, ColumnType type);

std::string csv_header(const std::vector<Column>& columns);
/// Rows as lines.
std::string csv_lines(const std::vector<Row>& rows);

/// Reads what the two functions above wrote. A last line without its end, as a killed process leaves it, is left out.
/// Throws InputError, with file and line, for anything else that does not fit the columns, and for a row that `check`,
/// which is called for each in turn, refuses by an InputError.
Table read_csv(const std::filesystem::path& path, std::vector<Column> columns,
               const std::function<void(const Row&)>& check = nullptr);

}  // namespace raypool::studies
