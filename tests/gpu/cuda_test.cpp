// On a GPU: the operations of the kernels, and the images of all forms. Skipped where there is none.

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <vector>

#include "core/base/error.h"
#include "gpu/cuda_device.h"
#include "tests/gpu/forms.h"
#include "tests/gpu/operations_check.h"

namespace raypool::gpu {

int launch_operations(std::uint32_t first, std::uint32_t count, std::uint32_t* out);

namespace {

/// Whether tests are to be skipped: not where RAYPOOL_GPU says that there is a GPU.
bool is_left_out() {
    return !has_cuda_device() && std::getenv("RAYPOOL_GPU") == nullptr;
}

TEST(CudaOperations, AreThoseOfTheHost) {
    if (is_left_out()) GTEST_SKIP() << "no NVIDIA GPU here";
    const auto device = cuda_device();
    constexpr std::uint32_t kPairs = 1 << 24;
    constexpr std::uint32_t kAtOnce = 1 << 20;
    const DeviceArray<std::uint32_t> memory(*device, std::size_t{kAtOnce} * kOperations);
    std::vector<std::uint32_t> out(memory.size());
    int apart = 0;
    for (std::uint32_t first = 0; first < kPairs && !testing::Test::HasFailure(); first += kAtOnce) {
        ASSERT_EQ(launch_operations(first, kAtOnce, memory.data()), 0);
        memory.copy_out(out);
        apart += check_operations(first, out);
    }
    RecordProperty("rounded_to_least_normal", apart);
    std::cout << apart << " results are 2^-126 on one and zero on the other\n";
}

class CudaForms : public testing::TestWithParam<FormCase> {};

TEST_P(CudaForms, MakeTheImageOfThePerPixelTracer) {
    if (is_left_out()) GTEST_SKIP() << "no NVIDIA GPU here";
    check_forms(GetParam(), [](int) { return cuda_device(); });
}
INSTANTIATE_TEST_SUITE_P(Scenes, CudaForms, testing::ValuesIn(kFormCases),
                         [](const auto& test) { return test.param.name; });

TEST(CudaDevice, IsRefusedWhereThereIsNone) {
    if (has_cuda_device()) GTEST_SKIP() << "there is one";
    EXPECT_THROW((void)cuda_device(), InputError);
}

}  // namespace
}  // namespace raypool::gpu
