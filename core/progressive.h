/// Renders in pieces, between which a caller may look, keep what there is, or stop.
#pragma once

#include <algorithm>

#include "core/engine.h"
#include "core/sums_file.h"

namespace raypool {

/// Renders the samples of settings, a few at a time: pieces grow until each takes about half a second, so that the pool
/// is drained seldom and the caller asked often. After each, go_on(range that was added) says whether to. Pieces change
/// no bit of the sums.
template <class Scalar, class GoOn>
RenderReport render_in_pieces(const Engine& engine, const CompiledScene<Scalar>& scene, RenderSettings settings,
                              Framebuffer& framebuffer, GoOn go_on) {
    constexpr double kPieceSeconds = 0.5;
    const std::int64_t end = settings.end_sample;
    RenderReport report;
    for (std::int64_t first = settings.first_sample, piece = 1; first < end; first = settings.end_sample) {
        settings.first_sample = first;
        settings.end_sample = std::min(first + piece, end);
        const RenderReport part = engine.render(scene, settings, framebuffer);
        report.add(part);
        if (!go_on(SampleRange{first, settings.end_sample})) break;
        if (part.seconds < kPieceSeconds / 2) piece *= 2;
    }
    return report;
}

}  // namespace raypool
