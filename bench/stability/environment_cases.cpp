// Rows 11h and 11j: images around the scene that are black, all or in part, or have a sun in one texel: how often
// texels are drawn, against how often their density says.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/stability/around.h"
#include "bench/stability/case.h"
#include "bench/stability/methods.h"

namespace raypool::stability {

namespace {

/// Of a black one, 32 texels high, with so many lit ones; the first is lit only if all are.
template <class Scalar>
Around<Scalar> with_lit(double lit) {
    return around<Scalar>(32, [=](std::int64_t column, std::int64_t row) {
        return (row * 64 + column + 1024) % 2048 < static_cast<std::int64_t>(lit) ? 1.0 : 0.0;
    });
}

// All is counted: random numbers are the multiples of 2^-24 below one.
constexpr std::int32_t kSteps = 1 << 24;

/// By texel, as parts of all random numbers. Nothing where directions are not drawn at all.
struct Chances {
    std::vector<double> said, done;
};

/// Of sums that a random number is searched in: the entry i is drawn from sums[i] to below sums[i + 1].
template <class Scalar>
std::vector<double> searched(const std::vector<Scalar>& sums) {
    const auto numbers_below = [](Scalar sum) {
        return std::clamp(std::ceil(static_cast<double>(sum) * kSteps), 0.0, double{kSteps});
    };
    std::vector<double> chances;
    for (std::size_t i = 0; i + 1 < sums.size(); ++i)
        chances.push_back(sums[i + 1] > sums[i] ? (numbers_below(sums[i + 1]) - numbers_below(sums[i])) / kSteps : 0);
    return chances;
}

constexpr auto kOurChances = []<class Scalar>(const Around<Scalar>& sky) -> Chances {
    const CompiledScene<Scalar> scene = sky.compiled();
    if (!scene.features.lights) return {};
    const auto drawn = [](std::int32_t count) {  // of as many entries, by the first number that draws each or a later
        std::vector<double> chances;
        for (std::int32_t i = 1, first = 0; i <= count; ++i) {
            const auto is_before = [=](std::int32_t step) {
                return draw_entry<Scalar>(static_cast<Scalar>(step) * Scalar(0x1p-24), static_cast<Scalar>(count)) < i;
            };
            std::int32_t next = first;  // by halves, since views are not for clang 14
            for (std::int32_t end = kSteps; next < end;) {
                const std::int32_t middle = next + (end - next) / 2;
                if (is_before(middle)) {
                    next = middle + 1;
                } else {
                    end = middle;
                }
            }
            chances.push_back(static_cast<double>(next - first) / kSteps);
            first = next;
        }
        return chances;
    };
    const auto chosen = []<class Row>(const Row* table, const std::vector<double>& drawn_chances) {
        std::vector<double> chances(drawn_chances.size());
        for (std::size_t i = 0; i < chances.size(); ++i) {
            const double kept =
                std::ceil(std::min(static_cast<double>(table[i].value[Row::kThreshold]), 1.0) * kSteps) / kSteps;
            chances[i] += drawn_chances[i] * kept;
            chances[static_cast<std::size_t>(bits_of<Scalar>(table[i].value[Row::kAlias]))] +=
                drawn_chances[i] * (1 - kept);
        }
        return chances;
    };
    const EnvironmentView<Scalar>& environment = scene.environment;
    const std::vector<double> columns = drawn(environment.width);
    Chances chances;
    for (const double of_row : chosen(environment.rows.data(), drawn(environment.height)))
        for (const double of_texel : chosen(environment.entries.data() + chances.done.size(), columns))
            chances.done.push_back(of_row * of_texel);
    for (std::size_t i = 0; i < sky.count(); ++i)
        chances.said.push_back(environment.texels[i].value[EnvironmentTexel<Scalar>::kDensity] * sky.solid_angle(i));
    return chances;
};

/// The running sum of all texels, divided by its last; a number is searched in it.
constexpr auto kRunningSum = []<class Scalar>(const Around<Scalar>& sky) -> Chances {
    std::vector<Scalar> sums{0};
    for (std::size_t i = 0; i < sky.count(); ++i) sums.push_back(sums.back() + static_cast<Scalar>(sky.weight(i)));
    const Scalar total = sums.back();
    for (Scalar& sum : sums) sum /= total;
    Chances chances{{}, searched(sums)};
    for (std::size_t i = 0; i < sky.count(); ++i) chances.said.push_back(sky.weight(i) / static_cast<double>(total));
    return chances;
};
/// The same, and the first sum is taken that is not below the number. So 0 takes the first texel, black or not.
constexpr auto kNotBelow = []<class Scalar>(const Around<Scalar>& sky) -> Chances {
    Chances chances = kRunningSum(sky);
    const auto first = std::find_if(chances.done.begin(), chances.done.end(), [](double chance) { return chance > 0; });
    if (first == chances.done.end()) return chances;
    *first -= 1.0 / kSteps;
    chances.done.front() += 1.0 / kSteps;
    return chances;
};
/// Shares of the exact sum are added up; what lies beyond the last sum takes the last texel.
constexpr auto kSumOfShares = []<class Scalar>(const Around<Scalar>& sky) -> Chances {
    double total = 0;
    for (std::size_t i = 0; i < sky.count(); ++i) total += sky.weight(i);
    Chances chances;
    std::vector<Scalar> sums{0};
    for (std::size_t i = 0; i < sky.count(); ++i) {
        chances.said.push_back(sky.weight(i) / total);
        sums.push_back(sums.back() + static_cast<Scalar>(chances.said.back()));
    }
    sums.back() = std::max(sums.back(), Scalar(1));
    chances.done = searched(sums);
    return chances;
};
/// pbrt's third edition, chapters 13.3.1 and 14.2.4: a running sum of a row's texels, and one of the rows.
constexpr auto kSumsOfRows = []<class Scalar>(const Around<Scalar>& sky) -> Chances {
    const auto normalised = [](std::vector<Scalar> sums) {
        const Scalar total = sums.back();
        for (Scalar& sum : sums) sum /= total;
        return searched(sums);
    };
    const auto width = static_cast<std::size_t>(sky.image->width);
    std::vector<std::vector<double>> in_row;
    std::vector<Scalar> totals{0}, weights;
    for (std::size_t texel = 0; texel < sky.count(); texel += width) {
        std::vector<Scalar> sums{0};
        for (std::size_t i = texel; i < texel + width; ++i) {
            weights.push_back(static_cast<Scalar>(sky.weight(i)));
            sums.push_back(sums.back() + weights.back() / static_cast<Scalar>(width));
        }
        totals.push_back(totals.back() + sums.back() / static_cast<Scalar>(sky.image->height));
        in_row.push_back(normalised(std::move(sums)));
    }
    const std::vector<double> rows = normalised(totals);
    Chances chances;
    for (std::size_t i = 0; i < sky.count(); ++i) {
        chances.done.push_back(rows[i / width] * in_row[i / width][i % width]);
        chances.said.push_back(static_cast<double>(weights[i] / totals.back()) / static_cast<double>(sky.count()));
    }
    return chances;
};
/// By luminance and the sine, with a density over the square that is taken for one over the sphere.
constexpr auto kNoSineInDensity = []<class Scalar>(const Around<Scalar>& sky) -> Chances {
    Chances chances = kRunningSum(sky);
    for (std::size_t i = 0; i < sky.count(); ++i)
        chances.said[i] *= static_cast<double>(sky.count()) / (4 * std::numbers::pi) * sky.solid_angle(i);
    return chances;
};

/// Random numbers that draw a black texel, share; all if there is none that draws any.
template <class Scalar>
double drawn_black(const Around<Scalar>& sky, const Chances& chances) {
    double black = 0, all = 0;
    for (std::size_t i = 0; i < chances.done.size(); ++i) {
        all += chances.done[i];
        black += sky.radiance(i) > 0 ? 0 : chances.done[i];
    }
    return all == 0 && !chances.done.empty() ? 1 : black;
}
constexpr auto kFewLit = []<class Scalar>(const auto& chances, double lit, std::int64_t) {
    const Around<Scalar> sky = with_lit<Scalar>(lit);
    return drawn_black(sky, chances(sky));
};
constexpr auto kBlackGround = []<class Scalar>(const auto& chances, double height, std::int64_t) {
    const auto rows = static_cast<std::int64_t>(height);
    const auto sky = around<Scalar>(rows, [=](auto, std::int64_t row) { return 2 * row < rows ? 1.0 : 0.0; });
    return drawn_black(sky, chances(sky));
};
/// Half the sum of what is drawn too often and too seldom.
constexpr auto kSunShare = []<class Scalar>(const auto& chances, double height, std::int64_t) {
    const auto rows = static_cast<std::int64_t>(height);
    const Chances found = chances(with_sun<Scalar>(rows, rows / 3, rows / 4));
    double apart = 0;
    for (std::size_t i = 0; i < found.done.size(); ++i) apart += std::abs(found.done[i] - found.said[i]) / 2;
    return apart;
};
/// Radiance over density, on average over what is drawn, against the integral of radiance.
constexpr auto kSunHeight = []<class Scalar>(const auto& chances, double degrees, std::int64_t) {
    const Around<Scalar> sky = with_sun<Scalar>(180, 120, static_cast<std::int64_t>(degrees));
    const Chances found = chances(sky);
    double brought = 0, sent = 0;
    for (std::size_t i = 0; i < sky.count(); ++i) {
        const double light = sky.radiance(i) * sky.solid_angle(i);
        sent += light;
        brought += found.said[i] > 0 ? light * found.done[i] / found.said[i] : 0;
    }
    return std::abs(brought / sent - 1);
};

}  // namespace

CaseMethods environment_cases() {
    return {
        {"black-image", Methods(kFewLit)
                            .naive("a running sum divided by its last, float", kRunningSum)
                            .naive("the first sum not below the number, float", kNotBelow)
                            .ours_in_both(kOurChances)},
        {"black-ground", Methods(kBlackGround)
                             .naive("shares added up, the rest to the last, float", kSumOfShares)
                             .ours_in_both(kOurChances)},
        {"sun-share", Methods(kSunShare)
                          .naive("a running sum of all texels, float", kRunningSum)
                          .naive<double>("a running sum of all texels, double", kRunningSum)
                          .other("sums of rows, then of texels, float", kSumsOfRows)
                          .ours_in_both(kOurChances)},
        {"sun-height",
         Methods(kSunHeight).naive("a density without the sine, float", kNoSineInDensity).ours_in_both(kOurChances)}};
}

}  // namespace raypool::stability
