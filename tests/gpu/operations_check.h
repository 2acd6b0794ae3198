/// Holds what a device made of pairs of numbers against the host.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <span>

#include <fmt/format.h>

#include "core/math/flush_denormals.h"
#include "tests/core/math/operations.h"

namespace raypool::gpu {

/// `out` is of the pairs from `first` on. Returns how many results the two rules for rounding to the least normal
/// number tell apart.
inline int check_operations(std::uint32_t first, std::span<const std::uint32_t> out) {
    const FlushDenormals flush;
    int wrong = 0;
    int apart = 0;
    for (std::size_t i = 0; i < out.size() / kOperations; ++i) {
        float a;
        float b;
        pair_of(first + static_cast<std::uint32_t>(i), a, b);
        std::uint32_t expected[kOperations];
        operate(a, b, expected);
        for (int k = 0; k < kOperations; ++k) {
            const std::uint32_t got = out[i * kOperations + static_cast<std::size_t>(k)];
            if (got == expected[k]) continue;
            if (is_rounding_to_normal(got, expected[k])) {
                ++apart;
                continue;
            }
            if (++wrong > 20) continue;
            ADD_FAILURE() << fmt::format("{} of a = {:08x}, b = {:08x}: {:08x} in place of {:08x}", kOperationNames[k],
                                         std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b), got,
                                         expected[k]);
        }
    }
    EXPECT_EQ(wrong, 0) << "of " << out.size() << " results";
    return apart;
}

}  // namespace raypool::gpu
