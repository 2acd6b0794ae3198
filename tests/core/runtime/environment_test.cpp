#include "core/runtime/environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/math/real.h"

namespace raypool {
namespace {

TEST(CodeWidths, NameTheInstructionSetsThatThisWasCompiledFor) {
    const CodeWidths widths = code_widths();
    const auto has = [&](const char* name) {
        return std::find(widths.instruction_sets.begin(), widths.instruction_sets.end(), name) !=
               widths.instruction_sets.end();
    };
    EXPECT_TRUE(has("sse2") || has("asimd"));
    EXPECT_EQ(has("avx512f"), widths.float_lanes == 16);
    EXPECT_EQ(has("avx"), widths.float_lanes >= 8);
    EXPECT_EQ(has("asimd"), widths.float_lanes == 4);
}

TEST(CodeWidths, AreThoseOfTheRegisters) {
    const CodeWidths widths = code_widths();
    EXPECT_EQ(widths.float_lanes, int{stdx::native_simd<float>::size()});
    EXPECT_EQ(widths.double_lanes, int{stdx::native_simd<double>::size()});
    const nlohmann::json simd = environment_json().at("simd");
    EXPECT_EQ(simd.at("stage_lanes").at("float"), widths.float_lanes);
    EXPECT_EQ(simd.at("tree_width").at("double"), widths.double_tree_width);
}

TEST(Environment, IsUtf8WhateverTheVariablesHold) {
    setenv("OMP_RAYPOOL_TEST", "a\xff", 1);
    const nlohmann::json environment = environment_json();
    unsetenv("OMP_RAYPOOL_TEST");
    EXPECT_EQ(environment.at("openmp").at("OMP_RAYPOOL_TEST"), valid_utf8("a\xff"));
    EXPECT_NO_THROW((void)environment.dump());
}

}  // namespace
}  // namespace raypool
