/// The runner of studies: every repeat of every case once, in turn, whatever interrupts it; and no wrong image.
#include "bench/studies/runner.h"

#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/core/scratch_folder.h"

namespace raypool::studies {
namespace {

/// Two cases of one image, run three times, and one that makes no image and runs once.
class Fake : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "fake"; }
    [[nodiscard]] std::string question() const override { return "Does it work?"; }
    [[nodiscard]] std::vector<Column> columns() const override {
        return {{"value", ColumnType::Real, "a number"}, {"hash", ColumnType::Text, "of the image"}};
    }
    [[nodiscard]] std::vector<Case> cases(const StudyOptions&) const override {
        const auto rows = [this](const char* id, std::vector<Row> made) {
            return [this, id, made] {
                order.emplace_back(id);
                if (order.size() == stop_after) is_stopped = true;
                return made;
            };
        };
        return {{"a", "image", 3, rows("a", {{0.5, "12"}})},
                {"b", "image", 3, rows("b", {{0.5, hash_of_b}})},
                {"two rows", "", 1, rows("two rows", {{1.0, nullptr}, {2.0, nullptr}})}};
    }
    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions&) const override {
        Summary summary;
        summary.notes.push_back(fmt::format("{} rows", data.rows().size()));
        summary.findings.push_back({"Figure 5", "a claim", "a figure", "ours", Verdict::Holds, ""});
        return summary;
    }

    const char* hash_of_b = "12";
    std::size_t stop_after = 0;
    mutable std::vector<std::string> order;
    mutable std::atomic<bool> is_stopped = false;
};

Table data_of(const ScratchFolder& folder) {
    std::vector<Column> columns{{"case", ColumnType::Text, ""}, {"repeat", ColumnType::Count, ""}};
    for (const Column& column : Fake().columns()) columns.push_back(column);
    return read_csv(folder / "data.csv", columns);
}

/// How often each repeat of each case stands in the data.
std::map<std::pair<std::string, int>, int> counts(const Table& data) {
    std::map<std::pair<std::string, int>, int> counts;
    for (const Row& row : data.rows()) ++counts[{row[0].get<std::string>(), row[1].get<int>()}];
    return counts;
}
const std::map<std::pair<std::string, int>, int> kComplete{
    {{"a", 0}, 1}, {{"a", 1}, 1}, {{"a", 2}, 1}, {{"b", 0}, 1}, {{"b", 1}, 1}, {{"b", 2}, 1}, {{"two rows", 0}, 2}};

TEST(StudyRunner, InterleavesRepeatsAndKeepsEveryRow) {
    const ScratchFolder folder;
    const Fake study;
    Progress progress;
    EXPECT_TRUE(run_study(study, {}, folder.path(), {false, nullptr, &progress}));
    EXPECT_THAT(study.order, testing::ElementsAre("a", "b", "two rows", "b", "a", "a", "b"));
    EXPECT_EQ(counts(data_of(folder)), kComplete);
    EXPECT_EQ(progress.paths, run_count(study, {}));
    EXPECT_THAT(file_text(folder / "summary.md"),
                testing::AllOf(testing::HasSubstr("8 rows"), testing::HasSubstr("**holds**")));
    const nlohmann::json run = nlohmann::json::parse(file_text(folder / "run.json"));
    EXPECT_TRUE(run.at("environment").contains("commit"));
    EXPECT_EQ(run.at("findings")[0].at("source"), "Figure 5");
}

TEST(StudyRunner, ResumesWithoutLosingOrRepeatingARow) {
    for (std::size_t stop_after = 1; stop_after <= 6; ++stop_after) {
        const ScratchFolder folder;
        Fake first;
        first.stop_after = stop_after;
        ASSERT_FALSE(run_study(first, {}, folder.path(), {false, &first.is_stopped, nullptr})) << stop_after;
        const std::size_t kept = data_of(folder).rows().size();
        EXPECT_GE(kept, stop_after);

        const Fake second;
        EXPECT_TRUE(run_study(second, {}, folder.path(), {}));
        EXPECT_EQ(first.order.size() + second.order.size(), 7U);
        EXPECT_EQ(counts(data_of(folder)), kComplete);
    }
}

TEST(StudyRunner, DropsTheLineThatAKilledProcessLeftHalfWritten) {
    const ScratchFolder folder;
    EXPECT_TRUE(run_study(Fake(), {}, folder.path(), {}));
    const std::string whole = file_text(folder / "data.csv");
    set_file_text(folder / "data.csv", whole.substr(0, whole.size() - 3));
    const Fake study;
    EXPECT_TRUE(run_study(study, {}, folder.path(), {}));
    EXPECT_THAT(study.order, testing::ElementsAre("b"));
    EXPECT_EQ(counts(data_of(folder)), kComplete);
}

TEST(StudyRunner, OfACompleteRunMeasuresNothingAgain) {
    const ScratchFolder folder;
    EXPECT_TRUE(run_study(Fake(), {}, folder.path(), {}));
    const std::string before = file_text(folder / "run.json");
    const Fake study;
    EXPECT_TRUE(run_study(study, {}, folder.path(), {}));
    EXPECT_TRUE(study.order.empty());
    EXPECT_EQ(file_text(folder / "run.json"), before);
}

/// Makes the folder's run one of another build.
void change_commit(const ScratchFolder& folder) {
    nlohmann::json run = nlohmann::json::parse(file_text(folder / "run.json"));
    run["environment"]["commit"] = "another";
    set_file_text(folder / "run.json", run.dump(2));
}

TEST(StudyRunner, SummarisesACompleteRunOfAnotherBuildAndKeepsItsOrigin) {
    const ScratchFolder folder;
    EXPECT_TRUE(run_study(Fake(), {}, folder.path(), {}));
    change_commit(folder);
    const Fake study;
    EXPECT_TRUE(run_study(study, {}, folder.path(), {}));
    EXPECT_TRUE(study.order.empty());
    EXPECT_THAT(file_text(folder / "summary.md"), testing::HasSubstr("commit another"));
}

TEST(StudyRunner, DoesNotGoOnWithTheRunOfAnotherBuild) {
    const ScratchFolder folder;
    Fake first;
    first.stop_after = 3;
    EXPECT_FALSE(run_study(first, {}, folder.path(), {false, &first.is_stopped, nullptr}));
    change_commit(folder);
    EXPECT_THROW(run_study(Fake(), {}, folder.path(), {}), InputError);
    EXPECT_EQ(data_of(folder).rows().size(), 4U);  // and what there was is untouched
}

TEST(StudyRunner, RefusesToMixTwoRunsAndSaysWhatDiffers) {
    const ScratchFolder folder;
    EXPECT_TRUE(run_study(Fake(), {}, folder.path(), {}));
    StudyOptions other;
    other.seed = 1;
    try {
        run_study(Fake(), other, folder.path(), {});
        FAIL() << "two runs were mixed";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("options differs"));
    }
    EXPECT_TRUE(run_study(Fake(), other, folder.path(), {true, nullptr, nullptr}));
}

TEST(StudyRunner, KeepsNoRowOfAWrongImage) {
    const ScratchFolder folder;
    Fake study;
    study.hash_of_b = "13";
    EXPECT_THROW(run_study(study, {}, folder.path(), {}), WrongImage);
    EXPECT_EQ(data_of(folder).where("case", "b").rows().size(), 0U);
    EXPECT_FALSE(std::filesystem::exists(folder / "summary.md"));
}

}  // namespace
}  // namespace raypool::studies
