// What the study `scene-size` says of figures that are known.

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/studies/registry.h"
#include "bench/studies/scene_size_summary.h"
#include "core/runtime/engine.h"

namespace raypool::studies {
namespace {

/// Five runs of each way: recursion at 1 M paths/s, a pool by its capacity, and the automatic one.
class SizedData {
  public:
    SizedData() : study_(make_study("scene-size")), table_(columns()) {}

    void add(std::int64_t shapes, const std::string& way, const Value& capacity, double rate, int repeats = 5,
             const std::map<std::string, Value>& more = {}) {
        for (int repeat = 0; repeat < repeats; ++repeat) {
            Row row(table_.columns().size(), nullptr);
            const auto set = [&](const char* column, const Value& value) { row[table_.index(column)] = value; };
            set("case", std::to_string(shapes) + way);
            set("repeat", repeat);
            set("threads", 1);
            set("kind", "spheres");
            set("shapes", shapes);
            set("depth", 50);
            set("way", way);
            set("capacity", capacity);
            set("tree_bytes", 56 * shapes);
            set("segments", 1000);
            set("mpaths_per_s", rate * (1 + 0.01 * repeat));
            set("ns_per_segment", 100.0);
            for (const auto& [column, value] : more) set(column.c_str(), value);
            table_.add(std::move(row));
        }
    }
    /// Of the automatic pool, with 1000 segments in all.
    void add_level(std::int64_t shapes, std::int64_t level, const ListLevel& lists) {
        add(shapes, "lists, automatic", 8192, 1, 1,
            {{"level", level},
             {"lists", lists.lists},
             {"list_rays", lists.rays},
             {"single_rays", lists.single_rays},
             {"lanes", lists.lanes}});
    }
    [[nodiscard]] Summary summary() const { return study_->summarise(table_, {}); }

  private:
    [[nodiscard]] std::vector<Column> columns() const {
        std::vector<Column> all{{"case", ColumnType::Text, ""}, {"repeat", ColumnType::Count, ""}};
        for (Column& column : study_->columns()) all.push_back(std::move(column));
        return all;
    }

    std::unique_ptr<Study> study_;
    Table table_;
};

SizedData two_sizes(double automatic_in_the_large) {
    SizedData data;
    for (const std::int64_t shapes : {1000, 100'000}) {
        const bool is_large = shapes > 1000;
        data.add(shapes, "recursion", nullptr, 1);
        data.add(shapes, "automatic", is_large ? 32'768 : 8192, is_large ? automatic_in_the_large : 3);
        data.add(shapes, "8192", 8192, is_large ? 0.8 : 3);
        data.add(shapes, "32768", 32'768, is_large ? 2.1 : 2.5);
    }
    return data;
}

TEST(SceneSize, NamesTheBestCapacityOfEachSceneAndTheSmallestThatWins) {
    const Summary summary = two_sizes(2.1).summary();
    ASSERT_EQ(summary.tables.size(), 1U);
    const TextTable& table = summary.tables.front();
    ASSERT_EQ(table.rows.size(), 2U);
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size());
    EXPECT_THAT(table.rows[0],
                testing::ElementsAre("1000 spheres", "0.06", "100", "3.00 (3.00 to 3.00)", "2.50 (2.50 to 2.50)",
                                     "3.00 (3.00 to 3.00)", "8192", "8192", "8192"));
    EXPECT_THAT(table.rows[1],
                testing::ElementsAre("100000 spheres", "5.60", "100", "0.80 (0.80 to 0.80)", "2.10 (2.10 to 2.10)",
                                     "2.10 (2.10 to 2.10)", "32768", "32768", "32768"));
}

TEST(SceneSize, JudgesTheDefaultPoolWhereItLeadsLeast) {
    const auto verdicts = [](double automatic_in_the_large) {
        std::vector<Verdict> found;
        for (const Finding& finding : two_sizes(automatic_in_the_large).summary().findings) {
            EXPECT_THAT(finding.ours, testing::HasSubstr("100000 spheres"));
            found.push_back(finding.verdict);
        }
        return found;
    };
    EXPECT_THAT(verdicts(2.1), testing::ElementsAre(Verdict::Holds, Verdict::Holds));
    EXPECT_THAT(verdicts(1.5), testing::ElementsAre(Verdict::DoesNotHold, Verdict::Holds));
    EXPECT_THAT(verdicts(0.7), testing::ElementsAre(Verdict::DoesNotHold, Verdict::DoesNotHold));
}

TEST(SceneSize, TellsCacheMissesOnlyWhereTheyWereCounted) {
    SizedData data = two_sizes(2.1);
    EXPECT_EQ(data.summary().tables.size(), 1U);
    data.add(1000, "cache misses, recursion", nullptr, 1, 1, {{"source", "cachegrind"}});
    EXPECT_EQ(data.summary().tables.size(), 2U);
    EXPECT_THAT(data.summary().tables.back().rows[0],
                testing::ElementsAre("1000 spheres", "recursion", "", "", "cachegrind"));
}

TEST(SceneSize, TellsHowLongListsAreAndHowFullTheirRegistersByLevel) {
    SizedData data = two_sizes(2.1);
    data.add_level(1000, 0, {.lists = 2, .rays = 1000, .single_rays = 0, .lanes = 1008});
    data.add_level(1000, 1, {.lists = 40, .rays = 800, .single_rays = 200, .lanes = 800});
    data.add_level(1000, 2, {.lists = 10, .rays = 50, .single_rays = 50, .lanes = 0});
    const TextTable table = data.summary().tables.back();
    EXPECT_THAT(table.rows, testing::ElementsAre(
                                testing::ElementsAre("1000 spheres", "0", "500.0", "99 %", "1.000", "0 %"),
                                testing::ElementsAre("1000 spheres", "1", "20.0", "75 %", "0.800", "25 %"),
                                testing::ElementsAre("1000 spheres", "2", "5.0", "", "0.050", "100 %")));
}

}  // namespace
}  // namespace raypool::studies
