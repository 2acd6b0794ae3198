/// The table of a study: what is written is what is read, and what was cut off is not.
#include "bench/studies/table.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/scratch_folder.h"

namespace raypool::studies {
namespace {

const std::vector<Column> kColumns{{"name", ColumnType::Text, ""},
                                   {"count", ColumnType::Count, ""},
                                   {"seconds", ColumnType::Real, ""},
                                   {"bias", ColumnType::Signed, ""}};

Table read_back(const std::string& text) {
    const ScratchFolder folder;
    set_file_text(folder / "data.csv", text);
    return read_csv(folder / "data.csv", kColumns);
}

TEST(StudyTable, ReadsWhatItWrote) {
    const std::vector<Row> rows{{"static,1", 3, 0.1, -0.1},
                                {"says \"no\"\nand goes on", 0, std::numeric_limits<double>::denorm_min(), 0},
                                {"1e10", std::numeric_limits<std::uint64_t>::max(), 1.0 / 3, -1e300},
                                {"", nullptr, nullptr, nullptr}};
    const Table table = read_back(csv_header(kColumns) + csv_lines(rows));
    ASSERT_EQ(table.rows().size(), rows.size());
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) EXPECT_EQ(table.rows()[i], rows[i]);
    EXPECT_TRUE(table.rows().back()[1].is_null());
    EXPECT_TRUE(table.rows()[2][0].is_string());  // a hash may look like a number
}

TEST(StudyTable, LeavesOutALastLineThatWasCutOff) {
    const std::string lines = csv_lines({{"a", 1, 0.5, 0}, {"b", 2, 0.25, 0}});
    for (std::size_t length = lines.find('\n') + 1; length < lines.size(); ++length) {
        const Table table = read_back(csv_header(kColumns) + lines.substr(0, length));
        EXPECT_EQ(table.rows().size(), 1U) << length;
    }
}

TEST(StudyTable, RefusesWhatDoesNotFitNamingTheLine) {
    const auto refusal = [](const std::string& text) -> std::string {
        try {
            read_back(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_THAT(refusal("name,count\n"), testing::HasSubstr("line 1"));
    EXPECT_THAT(refusal(csv_header(kColumns) + "a,1,2,3\na,x,2,3\n"),
                testing::HasSubstr("data.csv: line 3: count is x"));
    EXPECT_THAT(refusal(csv_header(kColumns) + "a,1\n"), testing::HasSubstr("line 2"));
    EXPECT_THAT(refusal(csv_header(kColumns) + "a,1,2,3,4\n"), testing::HasSubstr("line 2"));
    EXPECT_THAT(refusal(csv_header(kColumns) + "\"a\nb\",1,2,3\na,1,2\n"), testing::HasSubstr("line 4"));
    for (const char* word : {"nan", "-nan", "inf", "-inf", "infinity", "1e999", "-1", "-1e-300"})
        EXPECT_THAT(refusal(csv_header(kColumns) + "a,1," + word + ",0\n"), testing::HasSubstr("line 2: seconds is"));
    for (const char* word : {"nan", "inf", "-inf"})
        EXPECT_THAT(refusal(csv_header(kColumns) + "a,1,0," + word + "\n"), testing::HasSubstr("line 2: bias is"));
    EXPECT_THAT(refusal(csv_header(kColumns) + "a,-1,0,0\n"), testing::HasSubstr("line 2: count is -1"));
}

}  // namespace
}  // namespace raypool::studies
