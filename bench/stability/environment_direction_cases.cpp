// Rows 11h to 11k: directions toward an image around the scene that has few texels, or one that is bright; and the
// texel that a direction sees, at the poles, the seam and edges.

#include <cmath>
#include <numbers>

#include "bench/stability/around.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kColour = 0.7;

/// In the direction that lies so far around and down an image, as parts of it.
Vector3d toward(double around, double down) {
    const double sine = std::sin(kPi * down);
    return {-sine * std::sin(2 * kPi * around), std::cos(kPi * down), sine * std::cos(2 * kPi * around)};
}

/// Six random numbers, which draw a direction.
template <class Scalar>
using Numbers = std::array<Scalar, 6>;
/// The i-th of a sequence that fills the cube evenly: parts of the powers of the root of x^7 = x + 1.
template <class Scalar>
Numbers<Scalar> even_numbers(std::int64_t i) {
    constexpr double kRoot = 1.1127756842787055;
    Numbers<Scalar> numbers;
    double power = 1;
    for (Scalar& number : numbers) {
        power /= kRoot;
        const double part = 0.5 + static_cast<double>(i) * power;
        number = static_cast<Scalar>(std::floor((part - std::floor(part)) * 0x1p24) * 0x1p-24);
    }
    return numbers;
}

// Ways to draw a direction.
constexpr auto kOurDraw = []<class Scalar>(const EnvironmentView<Scalar>& view, const Numbers<Scalar>& numbers) {
    return sample_environment<Scalar>(view, {numbers[0], numbers[1], numbers[2], numbers[3]}, numbers[4], numbers[5]);
};
/// A texel's solid angle is taken for its width and height in angles times the sine of its middle.
constexpr auto kSineOfMiddle = []<class Scalar>(const EnvironmentView<Scalar>& view, const Numbers<Scalar>& numbers) {
    EnvironmentSample<Scalar> sample = kOurDraw(view, numbers);
    const double half = kPi / view.height / 2;
    sample.density *= static_cast<Scalar>(std::sin(half) / half);
    return sample;
};
/// Within a texel directions are drawn evenly in both angles, at the density of an even solid angle.
constexpr auto kEvenAngles = []<class Scalar>(const EnvironmentView<Scalar>& view, const Numbers<Scalar>& numbers) {
    EnvironmentSample<Scalar> sample = kOurDraw(view, numbers);
    const std::int32_t row = sample.texel_id / view.width;
    const std::int32_t column = sample.texel_id % view.width;
    sample.direction = narrow<Scalar>(toward((column + static_cast<double>(numbers[4])) / view.width,
                                             (row + static_cast<double>(numbers[5])) / view.height));
    return sample;
};
/// pbrt's third edition, chapter 14.2.4: the same at the density that it has.
constexpr auto kDensityOfAngles = []<class Scalar>(const EnvironmentView<Scalar>& view,
                                                   const Numbers<Scalar>& numbers) {
    EnvironmentSample<Scalar> sample = kEvenAngles(view, numbers);
    const auto row = static_cast<std::int32_t>(sample.texel_id) / view.width;
    const double down = (row + static_cast<double>(numbers[5])) / view.height;
    const double half = kPi / view.height / 2;
    const double middle = half * (2 * row + 1);
    sample.density *= static_cast<Scalar>(std::sin(middle) * std::sin(half) / (half * std::sin(kPi * down)));
    return sample;
};

std::int64_t whole(double value) {
    return static_cast<std::int64_t>(value);
}

/// Density against 1 / 4 pi, and radiance: the greatest error.
constexpr auto kOneColour = []<class Scalar>(const auto& draw, double height, std::int64_t samples) {
    const auto scene = around<Scalar>(whole(height), [](auto, auto) { return kColour; }).compiled();
    double most = 0;
    for (std::int64_t i = 0; i < samples; ++i) {
        const EnvironmentSample<Scalar> sample = draw(scene.environment, even_numbers<Scalar>(i));
        most = std::max({most, std::abs(4 * kPi * static_cast<double>(sample.density) - 1),
                         std::abs(static_cast<double>(sample.radiance[0]) / static_cast<float>(kColour) - 1)});
    }
    return most;
};
/// What a floor receives, against pi times the radiance.
constexpr auto kOneColourFloor = []<class Scalar>(const auto& draw, double height, std::int64_t samples) {
    const auto scene = around<Scalar>(whole(height), [](auto, auto) { return kColour; }).compiled();
    double sum = 0;
    for (std::int64_t i = 0; i < samples; ++i) {
        const EnvironmentSample<Scalar> sample = draw(scene.environment, even_numbers<Scalar>(i));
        sum += std::max(static_cast<double>(sample.direction[1]), 0.0) * static_cast<double>(sample.radiance[0]) /
               static_cast<double>(sample.density);
    }
    return std::abs(sum / static_cast<double>(samples) / (kPi * kColour) - 1);
};

// Ways to see an image.
constexpr auto kOurSight = []<class Scalar>(const CompiledScene<Scalar>& scene, const Image&, double around,
                                            double down) {
    return see_environment<Scalar>(scene.environment, narrow<Scalar>(toward(around, down)));
};
/// Radiance is interpolated between the middles of texels, and the density is that of the texel.
constexpr auto kInterpolated = []<class Scalar>(const CompiledScene<Scalar>& scene, const Image& image, double around,
                                                double down) {
    EnvironmentSight<Scalar> sight = kOurSight(scene, image, around, down);
    const double x = around * static_cast<double>(image.width) - 0.5;
    const double y = down * static_cast<double>(image.height) - 0.5;
    double radiance = 0;
    for (const double row : {std::floor(y), std::floor(y) + 1})
        for (const double column : {std::floor(x), std::floor(x) + 1})
            radiance += *image.pixel(whole(column), whole(row)) * (1 - std::abs(x - column)) * (1 - std::abs(y - row));
    for (Scalar& channel : sight.radiance) channel = static_cast<Scalar>(radiance);
    return sight;
};
/// Light from where the density is 0, of a lit square in a black image.
constexpr auto kLitSquare = []<class Scalar>(const auto& sight, double edge, std::int64_t samples) {
    constexpr std::int64_t kHeight = 64;
    const auto is_within = [edge](std::int64_t i) { return i >= 24 && static_cast<double>(i) < 24 + edge; };
    const Around<Scalar> sky =
        around<Scalar>(kHeight, [&](auto column, auto row) { return is_within(column) && is_within(row) ? 1.0 : 0.0; });
    const CompiledScene<Scalar> scene = sky.compiled();
    RandomInputs random(114);
    double lost = 0, all = 0;
    for (std::int64_t i = 0; i < samples; ++i) {
        const double across = random.uniform(23, 25 + edge) / (2 * kHeight);
        const double down = random.uniform(23, 25 + edge) / kHeight;
        const EnvironmentSight<Scalar> seen = sight(scene, *sky.image, across, down);
        const double light = static_cast<double>(seen.radiance[0]) * std::sin(kPi * down);
        all += light;
        lost += seen.density > 0 ? 0 : light;
    }
    return lost / all;
};

// Ways to find the texel of a direction.
constexpr auto kOurTexel = []<class Scalar>(const EnvironmentView<Scalar>& view, const Vec3<Scalar>& direction) {
    return environment_texel<Scalar>(view, direction);
};
/// pbrt's third edition: the arc cosine of the height, and an angle below 0 gets a turn more.
constexpr auto kArcCosine = []<class Scalar>(const EnvironmentView<Scalar>& view, const Vec3<Scalar>& direction) {
    constexpr Scalar kHalf = std::numbers::pi_v<Scalar>;
    const Scalar angle = std::atan2(-direction[0], direction[2]);
    const Scalar turn = (angle < 0 ? angle + 2 * kHalf : angle) / (2 * kHalf);
    const Scalar down = std::acos(std::clamp(direction[1], Scalar(-1), Scalar(1))) / kHalf;
    return static_cast<std::int32_t>(down * static_cast<Scalar>(view.height)) * view.width +
           static_cast<std::int32_t>(turn * static_cast<Scalar>(view.width));
};
template <class Scalar>
EnvironmentView<Scalar> view_of(double height) {
    EnvironmentView<Scalar> view;
    view.height = static_cast<std::int32_t>(height);
    view.width = 2 * view.height;
    return view;
}
/// Directions into one of the four rows next to a pole, not closer to an edge of the texel than a twentieth of it.
constexpr auto kPole = []<class Scalar>(const auto& texel, double height, std::int64_t samples) {
    const EnvironmentView<Scalar> view = view_of<Scalar>(height);
    return share_of(samples, RandomInputs(115), [&](RandomInputs& random) {
        const int from_pole = random.below(4);
        const int row = random.one_in(2) ? from_pole : view.height - 1 - from_pole;
        const int column = random.below(view.width);
        const double x = random.uniform(0.05, 0.95);
        const double y = random.uniform(0.05, 0.95);
        const Vector3d direction = toward((column + x) / view.width, (row + y) / view.height);
        return texel(view, narrow<Scalar>(direction)) != row * view.width + column;
    });
};
/// Directions so close to the seam, on either side of it: they see its row, and a column beside the seam.
constexpr auto kSeam = []<class Scalar>(const auto& texel, double angle, std::int64_t samples) {
    const EnvironmentView<Scalar> view = view_of<Scalar>(256);
    return share_of(samples, RandomInputs(116), [&](RandomInputs& random) {
        const int row = 32 + random.below(192);
        const double turn = random.one_in(2) ? angle / (2 * kPi) : -angle / (2 * kPi);
        const int found = texel(view, narrow<Scalar>(toward(turn, (row + 0.5) / view.height)));
        const int column = found - row * view.width;
        return column != 0 && column != view.width - 1;
    });
};

// Ways to tell the radiance of a drawn direction.
constexpr auto kDrawnRadiance = []<class Scalar>(const EnvironmentView<Scalar>&,
                                                 const EnvironmentSample<Scalar>& sample) {
    return sample.radiance[0];
};
constexpr auto kSeenRadiance = []<class Scalar>(const EnvironmentView<Scalar>& view,
                                                const EnvironmentSample<Scalar>& sample) {
    return see_environment<Scalar>(view, sample.direction).radiance[0];
};
/// Of directions drawn at the density of the sun those that see no sun.
constexpr auto kSunEdge = []<class Scalar>(const auto& radiance, double height, std::int64_t samples) {
    const std::int64_t rows = whole(height);
    const CompiledScene<Scalar> scene = with_sun<Scalar>(rows, rows / 3, rows / 4).compiled();
    const auto sun = static_cast<std::int32_t>(rows / 4 * 2 * rows + rows / 3);
    return share_of(samples, RandomInputs(117), [&](RandomInputs& random) -> std::optional<bool> {
        Numbers<Scalar> numbers;
        for (Scalar& number : numbers) number = random.unit_interval<Scalar>();
        const EnvironmentSample<Scalar> sample = kOurDraw(scene.environment, numbers);
        if (sample.texel_id != sun) return {};
        return radiance(scene.environment, sample) != Scalar(kSun);
    });
};

}  // namespace

CaseMethods environment_direction_cases() {
    return {{"lit-square", Methods(kLitSquare)
                               .naive("radiance between texels, density by texel, float", kInterpolated)
                               .ours_in_both(kOurSight)},
            {"one-colour",
             Methods(kOneColour).naive("by the sine of a texel's middle, float", kSineOfMiddle).ours_in_both(kOurDraw)},
            {"one-colour-floor", Methods(kOneColourFloor)
                                     .naive("even angles in a texel, float", kEvenAngles)
                                     .other("even angles at their density, float", kDensityOfAngles)
                                     .ours_in_both(kOurDraw)},
            {"sky-pole", Methods(kPole).naive("arc cosine of the height, float", kArcCosine).ours_in_both(kOurTexel)},
            {"sky-seam", Methods(kSeam).naive("a turn added below 0, float", kArcCosine).ours_in_both(kOurTexel)},
            {"sun-edge",
             Methods(kSunEdge).naive("looked up by the direction, float", kSeenRadiance).ours_in_both(kDrawnRadiance)}};
}

}  // namespace raypool::stability
