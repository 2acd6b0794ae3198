/// What OpenMP itself costs on this machine, and what its cores give to work that shares nothing.
#pragma once

#include <vector>

#include "bench/studies/replay_model.h"

namespace raypool::studies {

/// Seconds that each of `threads` threads takes for the same amount of arithmetic in registers, all at once: what
/// remains of the machine's speed when more threads run is no engine's fault. About `seconds` on one thread.
double compute_loop_seconds(int threads, double seconds);

/// Measured for thread counts up to the cores.
struct OpenMpCosts {
    std::vector<int> threads;
    std::vector<double> fetch_s;    ///< processor time of a thread that fetches a chunk of a dynamic loop
    std::vector<double> barrier_s;  ///< from the last thread's coming to a barrier until all go on

    /// Costs of a replay. A round of a shared pool has three barriers (wavefront/rounds.h). Beyond the cores that could
    /// be measured, a fetch costs what it costs with all of them, and a barrier grows with the logarithm of the
    /// threads.
    [[nodiscard]] ReplayCosts at(int thread_count) const;
};
OpenMpCosts measure_openmp_costs(int most_threads);

}  // namespace raypool::studies
