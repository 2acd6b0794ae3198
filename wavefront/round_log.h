/// What happened in each round: kept by each thread for itself when rounds are logged, otherwise free.
///
/// A stage's time is what passes between start() and stop(); what lies between a stop() and the next start() is
/// nobody's.
#pragma once

#include <omp.h>

#include <vector>

#include "core/engine.h"

namespace raypool::wavefront {

class RoundLog {
  public:
    explicit RoundLog(bool is_on) : is_on_(is_on) {}

    /// Starts the clock of a stage.
    void start() {
        if (is_on_) mark_ = omp_get_wtime();
    }
    /// What passed since start() or the last stop() belongs to `stage`.
    void stop(Stage stage) {
        if (!is_on_) return;
        const double now = omp_get_wtime();
        round().stage_s[static_cast<std::size_t>(stage)] += now - mark_;
        mark_ = now;
    }
    void waited(double seconds) {
        if (is_on_) round().wait_s += seconds;
    }
    /// Records that were advanced, those that survived, and the lanes that were used for them.
    void advanced(std::size_t records, std::size_t survivors, std::size_t lanes) {
        if (!is_on_) return;
        round().records_in += static_cast<std::int64_t>(records);
        round().records_out += static_cast<std::int64_t>(survivors);
        round().lanes += static_cast<std::int64_t>(lanes);
    }
    void end_round() {
        if (is_on_ && round_ + 1 < kMostRounds) ++round_;
    }
    [[nodiscard]] const std::vector<RoundWork>& rounds() const { return rounds_; }

  private:
    static constexpr std::size_t kMostRounds = 4096;  ///< later ones are added to the last
    RoundWork& round() {
        if (round_ >= rounds_.size()) rounds_.resize(round_ + 1);
        return rounds_[round_];
    }
    bool is_on_;
    double mark_ = 0;
    std::size_t round_ = 0;
    std::vector<RoundWork> rounds_;
};

}  // namespace raypool::wavefront
