/// The runner of studies: every repeat of every case once, in turn, whatever interrupts it; and no wrong image.
#include "bench/studies/runner.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/scratch_folder.h"

namespace raypool::studies {
namespace {

/// Two cases of one image, run three times, and one that makes no image and runs once.
struct Fake : Study {
    Fake() {
        name = "fake";
        question = "Does it work?";
        columns = {{"value", ColumnType::Real, "a number"}, {"hash", ColumnType::Text, "of the image"}};
        cases = [this](const StudyOptions&) -> std::vector<Case> {
            const auto rows = [this](const char* id, std::vector<Cells> made) {
                return [this, id, made] {
                    order.emplace_back(id);
                    if (order.size() == stop_after) stop_signal = 15;
                    return made;
                };
            };
            return {{"a", "image", 3, rows("a", {Cells{{"value", 0.5}, {"hash", "12"}}})},
                    {"b", "image", 3, rows("b", {Cells{{"value", 0.5}, {"hash", hash_of_b}}})},
                    {"two rows", "", 1, rows("two rows", {Cells{{"value", 1.0}}, Cells{{"value", 2.0}}})}};
        };
        facts = [this] { return nlohmann::json{{"cores", cores}}; };
    }
    Fake(const Fake&) = delete;  // its cases write into it
    Fake& operator=(const Fake&) = delete;

    const char* hash_of_b = "12";
    int cores = 2;
    std::size_t stop_after = 0;
    mutable std::vector<std::string> order;
    mutable std::atomic<int> stop_signal = 0;
};

Table data_of(const ScratchFolder& folder) {
    std::vector<Column> columns{{"case", ColumnType::Text, ""}, {"repeat", ColumnType::Count, ""}};
    for (const Column& column : Fake().columns) columns.push_back(column);
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
    EXPECT_EQ(data_of(folder).rows().size(), 8U);
    const nlohmann::json run = nlohmann::json::parse(file_text(folder / "run.json"));
    EXPECT_TRUE(run.at("environment").contains("commit"));
    EXPECT_TRUE(run.contains("finished"));
    EXPECT_GE(run.at("stolen"), 0);
    EXPECT_EQ(run.at("facts").at("cores"), 2);
    EXPECT_EQ(run.at("question"), "Does it work?");
}

TEST(StudyRunner, ResumesWithoutLosingOrRepeatingARow) {
    for (std::size_t stop_after = 1; stop_after <= 6; ++stop_after) {
        const ScratchFolder folder;
        Fake first;
        first.stop_after = stop_after;
        ASSERT_FALSE(run_study(first, {}, folder.path(), {false, &first.stop_signal, nullptr})) << stop_after;
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

TEST(StudyRunner, TakesUpACompleteRunOfAnotherBuildAndKeepsItsOrigin) {
    const ScratchFolder folder;
    EXPECT_TRUE(run_study(Fake(), {}, folder.path(), {}));
    change_commit(folder);
    Fake study;
    study.cores = 64;
    EXPECT_TRUE(run_study(study, {}, folder.path(), {}));
    EXPECT_TRUE(study.order.empty());
    const nlohmann::json run = nlohmann::json::parse(file_text(folder / "run.json"));
    EXPECT_EQ(run.at("environment").at("commit"), "another");
    EXPECT_EQ(run.at("facts").at("cores"), 2);
}

TEST(StudyRunner, FinishesARunWhoseLastRowWasItsLastWord) {
    const ScratchFolder folder;
    EXPECT_TRUE(run_study(Fake(), {}, folder.path(), {}));
    nlohmann::json run = nlohmann::json::parse(file_text(folder / "run.json"));
    run.erase("finished");
    set_file_text(folder / "run.json", run.dump(2));
    const Fake study;
    EXPECT_TRUE(run_study(study, {}, folder.path(), {}));
    EXPECT_TRUE(study.order.empty());
    EXPECT_TRUE(nlohmann::json::parse(file_text(folder / "run.json")).contains("finished"));
}

TEST(StudyRunner, DoesNotGoOnWithTheRunOfAnotherBuild) {
    const ScratchFolder folder;
    Fake first;
    first.stop_after = 3;
    EXPECT_FALSE(run_study(first, {}, folder.path(), {false, &first.stop_signal, nullptr}));
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
        EXPECT_THAT(error.what(), testing::HasSubstr("differs in options: seed)"));
    }
    EXPECT_TRUE(run_study(Fake(), other, folder.path(), {true, nullptr, nullptr}));
}

TEST(StudyRunner, RefusesRowsThatNoRunLeavesNamingTheLine) {
    const ScratchFolder folder;
    Fake first;
    first.stop_after = 6;
    EXPECT_FALSE(run_study(first, {}, folder.path(), {false, &first.stop_signal, nullptr}));
    const std::string whole = file_text(folder / "data.csv");
    const std::string header = whole.substr(0, whole.find('\n') + 1);
    const struct {
        std::string rows, refusal;
    } cases[] = {{"a,0,0.5,12\na,0,0.5,12\n", "line 3: repeat 0 of a is there already"},
                 {"a,0,0.5,12\nb,0,0.5,12\na,0,0.75,12\n", "line 4: repeat 0 of a is there already"},
                 {"two rows,0,1,\ntwo rows,0,2,\ntwo rows,0,1,\n", "line 4: repeat 0 of two rows is there already"},
                 {"c,0,0.5,12\n", "line 2: case c is none of this study"},
                 {"a,3,0.5,12\n", "line 2: repeat 3 of a, which has 3"},
                 {",0,0.5,12\n", "line 2: has no case"},
                 {"a,0,nan,12\n", "line 2: value is nan"},
                 {"a,0,0.5,12\nb,0,0.5,13\n", "line 3: b: the image has hash 13"}};
    for (const auto& [rows, refusal] : cases) {
        set_file_text(folder / "data.csv", header + rows);
        try {
            run_study(Fake(), {}, folder.path(), {});
            ADD_FAILURE() << rows << " was taken";
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("data.csv: " + refusal));
        }
        EXPECT_EQ(file_text(folder / "data.csv"), header + rows);
    }
}

TEST(StudyRunner, LeavesNoPartOfARepeatOnAFullDisk) {
    const ScratchFolder folder;
    Fake first;
    first.stop_after = 2;
    EXPECT_FALSE(run_study(first, {}, folder.path(), {false, &first.stop_signal, nullptr}));
    const std::string before = file_text(folder / "data.csv");
    const pid_t child = ::fork();
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{before.size() + 15, before.size() + 15};  // the first of two rows has 13 bytes
        ::setrlimit(RLIMIT_FSIZE, &limit);
        try {
            const Fake study;  // the cases run in it
            const std::vector<Case> cases = study.cases({});
            std::vector<Column> columns{{"case", ColumnType::Text, ""}, {"repeat", ColumnType::Count, ""}};
            for (const Column& column : study.columns) columns.push_back(column);
            RunData data(folder.path(), columns, cases);
            data.load();
            data.open();
            data.add(cases[2], 0, cases[2].run());
        } catch (const InputError&) {
            ::_exit(0);
        }
        ::_exit(1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(file_text(folder / "data.csv"), before);
    EXPECT_TRUE(run_study(Fake(), {}, folder.path(), {}));
    EXPECT_EQ(counts(data_of(folder)), kComplete);
}

TEST(StudyRunner, KeepsOthersOutOfItsFolder) {
    const ScratchFolder folder;
    {
        const FileLock lock = lock_folder(folder / "run");
        EXPECT_THROW(static_cast<void>(lock_folder(folder / "run")), InputError);
        EXPECT_TRUE(run_study(Fake(), {}, folder / "run", {}));
        EXPECT_THROW(static_cast<void>(lock_folder(folder / "run")), InputError);
        static_cast<void>(lock_folder(folder / "other"));
    }
    static_cast<void>(lock_folder(folder / "run"));
}

TEST(StudyRunner, KeepsNoRowOfAWrongImage) {
    const ScratchFolder folder;
    Fake study;
    study.hash_of_b = "13";
    EXPECT_THROW(run_study(study, {}, folder.path(), {}), WrongImage);
    const Table kept = data_of(folder);
    for (const Row& row : kept.rows()) EXPECT_NE(row[0], "b");
    EXPECT_FALSE(nlohmann::json::parse(file_text(folder / "run.json")).contains("finished"));
}

}  // namespace
}  // namespace raypool::studies
