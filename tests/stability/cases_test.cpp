/// Every case of numerical stability: ours holds the tolerance where the case asks it, and every naive method breaks.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bench/stability/case.h"

namespace raypool::stability {
namespace {

struct Tested {
    const Case* one;
    const Method* method;
};
void PrintTo(const Tested& tested, std::ostream* out) {
    *out << tested.one->id << ", " << tested.method->name;
}

std::vector<Tested> methods_of(Kind kind) {
    std::vector<Tested> tested;
    for (const Case& one : all_cases())
        for (const Method& method : one.methods)
            if (method.kind == kind) tested.push_back({&one, &method});
    return tested;
}
std::int64_t samples(const Case& one) {
    return one.samples / 10;
}
std::string test_name(const testing::TestParamInfo<Tested>& info) {
    std::string name = info.param.one->id + "_" + info.param.method->name;
    for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    return name;
}

class Ours : public testing::TestWithParam<Tested> {};
TEST_P(Ours, HoldsWhereTheCaseAsksIt) {
    const auto& [one, method] = GetParam();
    for (std::size_t i = 0; i < one->held; ++i)
        EXPECT_LE(method->error(one->values[i], samples(*one)), one->tolerance)
            << one->parameter << " " << one->values[i];
}
INSTANTIATE_TEST_SUITE_P(Stability, Ours, testing::ValuesIn(methods_of(Kind::Ours)), test_name);

class Naive : public testing::TestWithParam<Tested> {};
TEST_P(Naive, BreaksWithinTheCase) {
    const Case& one = *GetParam().one;
    const auto is_broken = [&](double value) { return GetParam().method->error(value, samples(one)) > one.tolerance; };
    EXPECT_TRUE(std::any_of(one.values.begin(), one.values.end(), is_broken));
}
INSTANTIATE_TEST_SUITE_P(Stability, Naive, testing::ValuesIn(methods_of(Kind::Naive)), test_name);

TEST(StabilityCases, AreOnesThatMakeSense) {
    std::set<std::string> ids;
    for (const Case& one : all_cases()) {
        SCOPED_TRACE(one.id);
        EXPECT_TRUE(ids.insert(one.id).second);
        EXPECT_LE(one.held, one.values.size());
        EXPECT_EQ(one.held == one.values.size(), one.limit.empty()) << "why not all?";
        std::set<std::string> names;
        for (const Method& method : one.methods) EXPECT_TRUE(names.insert(method.name).second) << method.name;
        EXPECT_TRUE(std::any_of(one.methods.begin(), one.methods.end(),
                                [](const Method& method) { return method.kind == Kind::Ours; }));
    }
}

/// Every row of the table in docs/stability.md that has an error, and at least three that the table lacked.
TEST(StabilityCases, CoverTheRows) {
    std::set<std::string> rows;
    for (const Case& one : all_cases()) rows.insert(one.row);
    for (const char* row :
         {"1a", "1b",  "1c",  "1d",  "1e",  "2a",  "2b",  "2c",  "2d",  "2f",  "3a",  "3b",  "3c",  "3d",  "4a", "4b",
          "4c", "4d",  "4e",  "4f",  "4g",  "5a",  "5b",  "5c",  "5d",  "5e",  "6a",  "6b",  "6c",  "7a",  "7b", "8a",
          "8b", "10a", "10b", "11a", "11b", "11c", "11d", "11e", "11f", "11g", "11h", "11i", "11j", "11k", "+"})
        EXPECT_TRUE(rows.contains(row)) << row;
}

}  // namespace
}  // namespace raypool::stability
