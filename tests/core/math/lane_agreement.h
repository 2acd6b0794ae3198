/// Compares a kernel one lane at a time with the same kernel a register wide, bit by bit.
///
/// A test gives two lambdas. `fill` writes the arguments of one call, scalar by scalar, into a Row; `kernel` reads them
/// in the same order, and hands every result to `out`:
///
///     expect_lanes_agree([]<class S>(RandomInputs& random, Row<S>& row) { row.vec(random.direction<S>()); },
///                        []<class Real>(Arguments<Real>& in, Results<Real>& out) { out(unit<Real>(in.vec())); });
///
/// In one row of eight some reals are replaced by zeros, denormals, infinities, not-a-numbers and the like. Any
/// not-a-number equals any other. Every other register runs again with denormals flushed, as in the engines; nothing
/// can then tell a denormal from zero, and so they are equal.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/runtime/engine.h"
#include "tests/random_inputs.h"

namespace raypool::test {

inline constexpr int kRowLanes = 16;  ///< rows compared at a time
inline constexpr int kMostColumns = 48;

/// What a kernel is called with: column by column, as many rows as the widest register has lanes.
template <class Scalar>
struct ArgumentTable {
    alignas(64) Scalar real[kMostColumns][kRowLanes];
    alignas(64) std::uint32_t word[kMostColumns][kRowLanes];
    int real_count = 0;
    int word_count = 0;
};

template <class Scalar>
class Row {
  public:
    Row(ArgumentTable<Scalar>& table, int row) : table_(table), row_(row) { table.real_count = table.word_count = 0; }
    void real(Scalar value) { table_.real[table_.real_count++][row_] = value; }
    void vec(const Vec3<Scalar>& v) { real(v[0]), real(v[1]), real(v[2]); }
    void flag(bool value) { real(value ? 1 : 0); }
    void word(std::uint32_t value) { table_.word[table_.word_count++][row_] = value; }

    void spoil(RandomInputs& random) {
        for (int c = 0; c < table_.real_count; ++c)
            if (random.one_in(4)) table_.real[c][row_] = random.special<Scalar>();
    }

  private:
    ArgumentTable<Scalar>& table_;
    int row_;
};

/// Reads the arguments of rows [first, first + lanes), in the order in which they were written.
template <class Real>
class Arguments {
  public:
    using Scalar = ScalarOf<Real>;
    Arguments(const ArgumentTable<Scalar>& table, int first) : table_(table), first_(first) {}

    Real real() { return load<Real>(table_.real[real_count_++] + first_); }
    Vec3<Real> vec() {
        const Real x = real(), y = real(), z = real();
        return vec3<Real>(x, y, z);
    }
    Mask<Real> flag() { return real() > Real(0); }
    Uint32<Real> word() { return load<Uint32<Real>>(table_.word[word_count_++] + first_); }
    /// A word below 2^31 as an index.
    Int<Real> index() {
        const std::uint32_t* words = table_.word[word_count_++] + first_;
        if constexpr (Simd<Real>) {
            return Int<Real>([&](auto i) { return static_cast<typename Int<Real>::value_type>(words[i]); });
        } else {
            return static_cast<Int<Real>>(*words);
        }
    }

  private:
    template <class V, class T>
    static V load(const T* from) {
        if constexpr (Simd<V>) {
            return V(from, stdx::element_aligned);
        } else {
            return *from;
        }
    }
    const ArgumentTable<Scalar>& table_;
    int first_;
    int real_count_ = 0;
    int word_count_ = 0;
};

/// Collects what a kernel returns, as bits.
template <class Real>
class Results {
  public:
    explicit Results(bool is_flushed) : is_flushed_(is_flushed) {}

    void operator()(const Real& value) {
        for (int i = 0; i < kLanes<Real>; ++i) bits[count][i] = bits_of(lane(value, i));
        ++count;
    }
    void operator()(const Vec3<Real>& v) { (*this)(v[0]), (*this)(v[1]), (*this)(v[2]); }
    template <std::size_t size>
    void operator()(const std::array<Real, size>& values) {
        for (const Real& value : values) (*this)(value);
    }
    void mask(const Mask<Real>& m) {
        integers([&](int i) { return mask_bits(m) >> i & 1U; });
    }
    void whole(const Int<Real>& value) {
        integers([&](int i) { return lane(value, i); });
    }

    std::uint64_t bits[kMostColumns][kLanes<Real>];
    int count = 0;

  private:
    [[nodiscard]] std::uint64_t bits_of(ScalarOf<Real> value) const {
        using Bits = std::conditional_t<sizeof(value) == 4, std::uint32_t, std::uint64_t>;
        constexpr Bits kSign = Bits{1} << (8 * sizeof(value) - 1);
        constexpr auto kLeastNormal = std::bit_cast<Bits>(std::numeric_limits<ScalarOf<Real>>::min());
        if (value != value) return ~std::uint64_t{0};
        const auto b = std::bit_cast<Bits>(value);
        return is_flushed_ && (b & ~kSign) < kLeastNormal ? b & kSign : b;
    }
    template <class Of>
    void integers(Of of) {
        for (int i = 0; i < kLanes<Real>; ++i) bits[count][i] = static_cast<std::uint64_t>(of(i));
        ++count;
    }
    bool is_flushed_;
};

namespace detail {

template <class Scalar>
std::string describe(const ArgumentTable<Scalar>& table, int row) {
    std::string text;
    for (int c = 0; c < table.real_count; ++c) text += fmt::format(" {:a}", table.real[c][row]);
    for (int c = 0; c < table.word_count; ++c) text += fmt::format(" {}u", table.word[c][row]);
    return text;
}

template <class Real, class Kernel>
[[gnu::noinline]] Results<Real> run(const ArgumentTable<ScalarOf<Real>>& table, int first, Kernel& kernel,
                                    bool is_flushed) {
    Arguments<Real> in(table, first);
    Results<Real> results(is_flushed);
    kernel(in, results);
    return results;
}

/// Whether the kernel at width Real gives what it gave one lane at a time.
template <class Real, class Kernel>
bool compare(const ArgumentTable<ScalarOf<Real>>& table, Kernel& kernel, bool is_flushed,
             const std::vector<Results<ScalarOf<Real>>>& alone) {
    for (int first = 0; first < kRowLanes; first += kLanes<Real>) {
        const Results<Real> results = run<Real>(table, first, kernel, is_flushed);
        for (int c = 0; c < results.count; ++c) {
            for (int i = 0; i < kLanes<Real>; ++i) {
                const std::uint64_t wanted = alone[first + i].bits[c][0];
                if (results.bits[c][i] == wanted) continue;
                ADD_FAILURE() << fmt::format("result {}, lane {} of {}{}: {:x} but alone {:x}; arguments:{}", c, i,
                                             kLanes<Real>, is_flushed ? ", flushed" : "", results.bits[c][i], wanted,
                                             describe(table, first + i));
                return false;
            }
        }
    }
    return true;
}

template <class... Reals, class Kernel, class Scalar>
bool compare_all(const ArgumentTable<Scalar>& table, Kernel& kernel, bool is_flushed) {
    std::vector<Results<Scalar>> alone;
    for (int row = 0; row < kRowLanes; ++row) alone.push_back(run<Scalar>(table, row, kernel, is_flushed));
    return (compare<Reals>(table, kernel, is_flushed, alone) && ...);
}

}  // namespace detail

/// Compares Scalar with each of `Reals` on `inputs` rows.
template <class Scalar, class... Reals, class Fill, class Kernel>
void expect_lanes_agree_for(int inputs, Fill fill, Kernel kernel) {
    RandomInputs random(20240607);
    ArgumentTable<Scalar> table;
    for (int done = 0; done < inputs; done += kRowLanes) {
        for (int i = 0; i < kRowLanes; ++i) {
            Row<Scalar> row(table, i);
            fill(random, row);
            if (random.one_in(8)) row.spoil(random);
        }
        if (!detail::compare_all<Reals...>(table, kernel, false)) return;
        if (done / kRowLanes % 2 != 0) continue;
        const FlushDenormals flush;
        if (!detail::compare_all<Reals...>(table, kernel, true)) return;
    }
}

/// Compares float with every width of float, and double with the native width of double.
template <class Fill, class Kernel>
void expect_lanes_agree(Fill fill, Kernel kernel, int inputs = kInputs) {
    expect_lanes_agree_for<float, stdx::native_simd<float>, Wide<float, kTreeWidth<float>>>(inputs, fill, kernel);
    expect_lanes_agree_for<double, stdx::native_simd<double>>(inputs, fill, kernel);
}

}  // namespace raypool::test
