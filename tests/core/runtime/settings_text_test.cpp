#include "core/runtime/settings_text.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "core/base/error.h"

namespace raypool {
namespace {

/// OMP_SCHEDULE as this says while it lives.
class OmpSchedule {
  public:
    explicit OmpSchedule(const char* text) { setenv("OMP_SCHEDULE", text, 1); }
    OmpSchedule(const OmpSchedule&) = delete;
    OmpSchedule& operator=(const OmpSchedule&) = delete;
    ~OmpSchedule() { unsetenv("OMP_SCHEDULE"); }
};

TEST(Schedule, IsReadAsItIsWritten) {
    for (const char* text : {"balanced", "static", "static,3", "dynamic,4", "guided", "tasks", "tasks,7"})
        EXPECT_EQ(to_string(parse_schedule(text)), text);
    for (const char* text : {"", "auto", "fair", "dynamic,-1", "dynamic,0", "static,", "guided,2147483648",
                             "balanced,1", "balanced,", "tasks,0", "Static", "monotonic:static", "static,1,2"})
        EXPECT_THROW(parse_schedule(text), InputError) << text;
}

TEST(ScheduleOfEnvironment, IsNoneWhereOpenMpIsToldNothing) {
    unsetenv("OMP_SCHEDULE");
    EXPECT_FALSE(schedule_of_environment());
}

TEST(ScheduleOfEnvironment, IsWhatTheVariableSaysInAnyCaseAndWithBlanks) {
    const std::pair<const char*, const char*> texts[] = {
        {"static", "static"}, {"STATIC,3", "static,3"}, {" dynamic , 4 ", "dynamic,4"}, {"Guided", "guided"}};
    for (const auto& [text, understood] : texts) {
        const OmpSchedule variable(text);
        EXPECT_EQ(to_string(*schedule_of_environment()), understood);
    }
}

TEST(ScheduleOfEnvironment, RefusesByItsNameWhatOpenMpHasNotOrARecordCouldNotTell) {
    for (const char* text : {"", "auto", "fair", "dynamic,-1", "dynamic,0", "static,", "guided,2147483648",
                             "monotonic:static", "nonmonotonic:dynamic,4", "static,1,2", "tasks", "balanced"}) {
        const OmpSchedule variable(text);
        try {
            schedule_of_environment();
            ADD_FAILURE() << text;
        } catch (const InputError& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with("OMP_SCHEDULE: must be static, dynamic or guided"))
                << text;
        }
    }
}

TEST(ChosenSchedule, IsTheOptionsThenTheVariablesThenBalancedUnlessThereIsAGrain) {
    unsetenv("OMP_SCHEDULE");
    EXPECT_EQ(to_string(chosen_schedule({}, {})), "balanced");
    EXPECT_EQ(to_string(chosen_schedule({}, "line")), "dynamic");
    EXPECT_EQ(to_string(chosen_schedule("static,2", "line")), "static,2");
    const OmpSchedule variable("guided,5");
    EXPECT_EQ(to_string(chosen_schedule({}, {})), "guided,5");
    EXPECT_EQ(to_string(chosen_schedule({}, "pixel")), "guided,5");
    EXPECT_EQ(to_string(chosen_schedule("balanced", {})), "balanced");
}

}  // namespace
}  // namespace raypool
