/// The images of failure: the naive method ruins them, and single precision with ours does not.
#include <gtest/gtest.h>

#include "bench/stability/failures.h"

namespace raypool::stability {
namespace {

class FailedImage : public testing::TestWithParam<std::size_t> {};
TEST_P(FailedImage, IsTheNaiveMethodsAndNotOurs) {
    Failure failure = all_failures()[GetParam()];
    failure.scene.width = 60;
    failure.scene.height = 40;
    RenderSettings settings;
    settings.end_sample = 4;
    const FailureImages images = render_failure(failure.variant, failure.scene, settings);
    const double naive = changed_share(images.naive, images.reference);
    const double ours = changed_share(images.ours, images.reference);
    EXPECT_GT(naive, 0.02) << failure.id;
    EXPECT_GT(naive, 3 * ours) << failure.id;
}
INSTANTIATE_TEST_SUITE_P(Stability, FailedImage, testing::Range(std::size_t{0}, all_failures().size()),
                         [](const auto& info) { return all_failures()[info.param].id; });

}  // namespace
}  // namespace raypool::stability
