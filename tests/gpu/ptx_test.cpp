// The PTX that nvcc makes of the kernels, translated and run, makes the image of every other engine.

#include <gtest/gtest.h>

#include "tests/gpu/forms.h"
#include "tests/gpu/ptx/device.h"

namespace raypool::gpu {
namespace {

class PtxForms : public testing::TestWithParam<FormCase> {};

TEST_P(PtxForms, MakeTheImageOfThePerPixelTracer) {
    check_forms(GetParam(), [](int) { return std::make_unique<PtxDevice>(); });
}
INSTANTIATE_TEST_SUITE_P(Scenes, PtxForms, testing::ValuesIn(kFormCases),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace raypool::gpu
