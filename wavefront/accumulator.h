/// Accumulators to choose from: each by its name, with what it takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/film/framebuffer.h"
#include "wavefront/accumulator_base.h"
#include "wavefront/integer_accumulators.h"
#include "wavefront/real_accumulator.h"
#include "wavefront/settings.h"

namespace raypool::wavefront {

/// What the sums of an accumulator of its own take; 0 where it adds to the framebuffer itself.
inline std::size_t accumulator_bytes(Accumulator kind, const Framebuffer& framebuffer, int threads) {
    const std::size_t sums = framebuffer.sums().size();
    switch (kind) {
        case Accumulator::OwnedInt64:
        case Accumulator::AtomicInt64:
            return 0;
        case Accumulator::PrivateInt64:
            return static_cast<std::size_t>(threads) * (sums * sizeof(std::int64_t) + block_count_of(sums / 3));
        case Accumulator::OwnedPlanarInt64:
        case Accumulator::AtomicPlanarInt64:
            return sums * sizeof(std::int64_t);
        case Accumulator::AtomicFloat:
            return sums * sizeof(float);
        case Accumulator::AtomicDouble:
            return sums * sizeof(double);
    }
    return 0;
}

template <class Scalar>
std::unique_ptr<AccumulatorBase<Scalar>> make_accumulator(Accumulator kind, Framebuffer& framebuffer, int threads) {
    switch (kind) {
        case Accumulator::OwnedInt64:
            return std::make_unique<InterleavedInt64<Scalar, Addition::Plain>>(framebuffer);
        case Accumulator::AtomicInt64:
            return std::make_unique<InterleavedInt64<Scalar, Addition::Atomic>>(framebuffer);
        case Accumulator::PrivateInt64:
            return std::make_unique<PrivateInt64<Scalar>>(framebuffer, threads);
        case Accumulator::OwnedPlanarInt64:
            return std::make_unique<PlanarInt64<Scalar, Addition::Plain>>(framebuffer);
        case Accumulator::AtomicPlanarInt64:
            return std::make_unique<PlanarInt64<Scalar, Addition::Atomic>>(framebuffer);
        case Accumulator::AtomicFloat:
            return std::make_unique<AtomicReal<Scalar, float>>(framebuffer);
        case Accumulator::AtomicDouble:
            return std::make_unique<AtomicReal<Scalar, double>>(framebuffer);
    }
    return nullptr;
}

}  // namespace raypool::wavefront
