#include "bench/studies/table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool::studies {

namespace {

std::size_t column_index(const std::vector<Column>& columns, std::string_view name) {
    const auto found = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
    RAYPOOL_CHECK(found != columns.end(), "a study knows its columns");
    return static_cast<std::size_t>(found - columns.begin());
}

std::string cell(const Value& value) {
    if (value.is_null()) return "";
    if (value.is_number_unsigned()) return fmt::format("{}", value.get<std::uint64_t>());
    if (value.is_number_integer()) return fmt::format("{}", value.get<std::int64_t>());
    if (value.is_number()) return fmt::format("{}", value.get<double>());
    const auto& text = value.get_ref<const std::string&>();
    if (!text.empty() && text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted(1, '"');
    for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
    return quoted.append(1, '"');
}

/// The cells of one line, which starts at `text` and ends with '\n'; moves `text` behind it. Nothing if it has no end.
std::optional<std::vector<std::string>> next_line(std::string_view& text) {
    std::vector<std::string> cells(1);
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"') {
            if (!is_quoted && i > 0 && text[i - 1] == '"') cells.back() += c;  // two within quotes are one
            is_quoted = !is_quoted;
        } else if (is_quoted || (c != ',' && c != '\n')) {
            cells.back() += c;
        } else if (c == ',') {
            cells.emplace_back();
        } else {
            text.remove_prefix(i + 1);
            return cells;
        }
    }
    return std::nullopt;
}

/// The value of a cell in such a column; nothing where it is none.
std::optional<Value> parse(const std::string& text, ColumnType type) {
    if (text.empty()) return Value(nullptr);
    if (type == ColumnType::Text) return Value(text);
    const Value value = Value::parse(text, nullptr, false);
    const bool is_right = type == ColumnType::Count ? value.is_number_unsigned() : value.is_number();
    return is_right ? std::optional(value) : std::nullopt;
}

/// Adds a line that has been read to the table.
void add_line(Table& table, const std::vector<std::string>& cells, const std::function<void(const Row&)>& check) {
    const std::vector<Column>& columns = table.columns();
    if (cells.size() != columns.size())
        throw InputError(fmt::format("{} values in place of {}", cells.size(), columns.size()));
    Row row;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::optional<Value> value = parse(cells[i], columns[i].type);
        const std::string wrong = value ? fault(*value, columns[i].type) : "is " + cells[i];
        if (!wrong.empty()) throw InputError(fmt::format("{} {}", columns[i].name, wrong));
        row.push_back(*value);
    }
    if (check) check(row);
    table.add(std::move(row));
}

}  // namespace

Cells operator+(Cells cells, const Cells& more) {
    cells.insert(cells.end(), more.begin(), more.end());
    return cells;
}

Row row_of(const std::vector<Column>& columns, const Cells& cells) {
    Row row(columns.size());
    for (const auto& [name, value] : cells) row[column_index(columns, name)] = value;
    return row;
}

std::size_t Table::index(std::string_view column) const {
    return column_index(columns_, column);
}

void Table::add(Row row) {
    RAYPOOL_CHECK(row.size() == columns_.size(), "a row has a value for each column");
    rows_.push_back(std::move(row));
}

std::string fault(const Value& value, ColumnType type) {
    if (!value.is_number()) return "";
    const auto number = value.get<double>();
    const bool is_right = std::isfinite(number) && (number >= 0 || type == ColumnType::Signed);
    return is_right ? "" : fmt::format("is {}", number);
}

std::string csv_header(const std::vector<Column>& columns) {
    Row names;
    for (const Column& column : columns) names.emplace_back(column.name);
    return csv_lines({names});
}

std::string csv_lines(const std::vector<Row>& rows) {
    std::string text;
    for (const Row& row : rows) {
        for (const Value& value : row) text.append(cell(value)).append(1, ',');
        text.back() = '\n';
    }
    return text;
}

Table read_csv(const std::filesystem::path& path, std::vector<Column> columns,
               const std::function<void(const Row&)>& check) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError(fmt::format("{}: cannot read", path.string()));
    const std::string content((std::istreambuf_iterator<char>(file)), {});
    std::string_view text(content);
    const std::string header = csv_header(columns);
    if (!text.starts_with(header))
        throw InputError(fmt::format("{}: line 1: the columns are not those of this study", path.string()));
    text.remove_prefix(header.size());

    Table table(std::move(columns));
    for (std::size_t line = 2;;) {
        const std::string_view rest = text;
        const auto cells = next_line(text);
        if (!cells) return table;
        try {
            add_line(table, *cells, check);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}: line {}: {}", path.string(), line, error.what()));
        }
        const std::string_view read = rest.substr(0, rest.size() - text.size());
        line += static_cast<std::size_t>(std::count(read.begin(), read.end(), '\n'));  // a text may have some
    }
}

}  // namespace raypool::studies
