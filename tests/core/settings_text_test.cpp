#include "core/settings_text.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "core/error.h"

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

TEST(DefaultSchedule, IsDynamicWhereOpenMpIsToldNothing) {
    unsetenv("OMP_SCHEDULE");
    EXPECT_EQ(to_string(default_schedule()), "dynamic");
}

TEST(DefaultSchedule, IsWhatTheVariableSaysInAnyCaseAndWithBlanks) {
    const std::pair<const char*, const char*> texts[] = {
        {"static", "static"}, {"STATIC,3", "static,3"}, {" dynamic , 4 ", "dynamic,4"}, {"Guided", "guided"}};
    for (const auto& [text, understood] : texts) {
        const OmpSchedule variable(text);
        EXPECT_EQ(to_string(default_schedule()), understood);
    }
}

TEST(DefaultSchedule, RefusesByItsNameWhatTheOptionRefuses) {
    for (const char* text : {"", "auto", "fair", "dynamic,-1", "dynamic,0", "static,", "guided,2147483648",
                             "monotonic:static", "nonmonotonic:dynamic,4", "static,1,2"}) {
        EXPECT_THROW(parse_schedule(text), InputError) << text;
        const OmpSchedule variable(text);
        try {
            default_schedule();
            ADD_FAILURE() << text;
        } catch (const InputError& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with("OMP_SCHEDULE: must be static, dynamic or guided"))
                << text;
        }
    }
}

}  // namespace
}  // namespace raypool
