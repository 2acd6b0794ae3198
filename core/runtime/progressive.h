/// Renders in pieces, between which a caller may look, keep what there is, or stop.
#pragma once

#include <algorithm>

#include "core/film/checkpoint.h"
#include "core/runtime/engine.h"

namespace raypool {

/// Renders the samples of settings, a few at a time: pieces grow until each takes about half a second, so that the pool
/// is drained seldom and the caller asked often. After each, go_on(range that was added) says whether to; what it wants
/// to see of the framebuffer it merges first. Pieces change no bit of the sums.
template <class GoOn>
void render_in_pieces(RenderSession& session, const RenderSettings& settings, GoOn go_on) {
    constexpr double kPieceSeconds = 0.5;
    std::int64_t size = 1;
    for (SampleRange piece{settings.first_sample, settings.first_sample}; piece.end < settings.end_sample;) {
        piece = {piece.end, std::min(piece.end + size, settings.end_sample)};
        const double seconds = session.add({piece.first, piece.end, settings.pixels}).seconds;
        if (!go_on(piece)) return;
        if (seconds < kPieceSeconds / 2) size *= 2;
    }
}

}  // namespace raypool
