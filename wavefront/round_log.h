/// What happened in each round: kept by each thread for itself when rounds are logged or traced, otherwise free.
///
/// Its memory is taken when it is made; within a render it takes no more and throws nothing.
///
/// A stage's time is what passes between start() and stop(), less what stop_within() says of stages within it; what
/// lies between a stop() and the next start() is counted for none. In the trace a round is what lies between two calls
/// of end_round().
#pragma once

#include <utility>
#include <vector>

#include "core/base/clock.h"
#include "core/runtime/settings.h"
#include "core/runtime/trace.h"
#include "wavefront/pool_report.h"

namespace raypool::wavefront {

class RoundLog {
  public:
    RoundLog(const RenderSettings& settings, int thread)
        : is_on_(settings.log_rounds || settings.trace != nullptr), trace_(settings.trace), thread_(thread) {
        if (is_on_) rounds_.reserve(kMostRounds);
    }

    /// A unit of the render begins.
    void begin() {
        if (!is_on_) return;
        rounds_.clear();
        round_ = 0;
        round_begin_s_ = mark_s_ = wall_seconds();
        lane_ = trace_ == nullptr ? nullptr : &trace_->lane(thread_);
        traced_rounds_ = 0;
        traced_ = {};
        batch_ = kNoBatch;
    }

    /// From now on a batch of a shared pool is worked on.
    void start_batch(std::int64_t batch) {
        ahead_ = 0;
        if (lane_ == nullptr) return;
        end_span();
        batch_ = batch;
    }
    /// The batch goes on, ahead of the others: what follows is of the next round, until the batch or the round ends.
    void go_ahead() {
        if (round_ + ahead_ + 1 < kMostRounds) ++ahead_;
    }
    /// Starts the clock of a stage.
    void start() {
        if (!is_on_) return;
        mark_s_ = wall_seconds();
        within_s_ = 0;
    }
    [[nodiscard]] double now() const { return is_on_ ? wall_seconds() : 0; }
    /// What passed since `begin_s`, which now() said, belongs to `stage`, and not to the one that is under way.
    void stop_within(Stage stage, double begin_s, std::size_t records) {
        if (!is_on_) return;
        const double end_s = wall_seconds();
        round().stage_s[static_cast<std::size_t>(stage)] += end_s - begin_s;
        within_s_ += end_s - begin_s;
        if (lane_ != nullptr) put_span({stage, begin_s, end_s, static_cast<std::int64_t>(records), 0});
    }
    /// What passed since start() or the last stop() belongs to `stage`, which worked on `records`.
    void stop(Stage stage, std::size_t records) {
        if (!is_on_) return;
        const double now = wall_seconds();
        round().stage_s[static_cast<std::size_t>(stage)] += now - mark_s_ - std::exchange(within_s_, 0);
        if (lane_ != nullptr) add_span({stage, mark_s_, now, static_cast<std::int64_t>(records), 0});
        mark_s_ = now;
    }
    void waited(double begin_s, double end_s) {
        if (!is_on_) return;
        round().wait_s += end_s - begin_s;
        if (lane_ == nullptr) return;
        end_span();
        lane_->span("wait", begin_s, end_s);
    }
    /// Records that were advanced, those that survived, and the lanes that were used for them.
    void advanced(std::size_t records, std::size_t survivors, std::size_t lanes) {
        if (!is_on_) return;
        RoundReport work;
        work.records_in = static_cast<std::int64_t>(records);
        work.records_out = static_cast<std::int64_t>(survivors);
        work.lanes = static_cast<std::int64_t>(lanes);
        round().add(work);
        traced_.add(work);
    }
    /// Shadow rays that were traced, those that met something before their light, and the lanes that were used for
    /// them.
    void traced_shadows(std::size_t rays, std::size_t hits, std::size_t lanes) {
        if (!is_on_) return;
        round().shadow_rays += static_cast<std::int64_t>(rays);
        round().shadow_hits += static_cast<std::int64_t>(hits);
        round().shadow_lanes += static_cast<std::int64_t>(lanes);
    }
    /// `records` are in the pool, which is of this thread alone or of all.
    void occupancy(std::size_t records, Trace::Event::Kind pool) {
        if (lane_ != nullptr) lane_->occupancy(wall_seconds(), static_cast<std::int64_t>(records), pool);
    }
    void end_round() {
        ahead_ = 0;
        if (!is_on_) return;
        if (round_ + 1 < kMostRounds) ++round_;
        if (lane_ == nullptr) return;
        end_span();
        const double now = wall_seconds();
        lane_->span(
            "round", round_begin_s_, now,
            {{{"round", traced_rounds_++}, {"records", traced_.records_in}, {"survivors", traced_.records_out}}});
        traced_ = {};
        round_begin_s_ = now;
        batch_ = kNoBatch;
    }
    /// After the last round.
    void finish() {
        if (lane_ != nullptr) end_span();
    }
    [[nodiscard]] const std::vector<RoundReport>& rounds() const { return rounds_; }

  private:
    static constexpr std::size_t kMostRounds = 4096;  ///< later ones are added to the last
    static constexpr std::int64_t kNoBatch = -1;

    struct Span {
        Stage stage;
        double begin_s, end_s;
        std::int64_t records;
        double append_s;  ///< of a span of Generate: for passing its records on
    };
    /// Camera rays enter a few registers at a time, and are passed on at once: spans of a thousandth of a round, which
    /// are joined to one.
    void add_span(const Span& span) {
        if (has_span_ && span_.stage == Stage::Generate && span.stage == Stage::Generate) {
            span_.end_s = span.end_s;
            span_.records += span.records;
        } else if (has_span_ && span_.stage == Stage::Generate && span.stage == Stage::Append) {
            span_.end_s = span.end_s;
            span_.append_s += span.end_s - span.begin_s;
        } else {
            end_span();
            span_ = span;
            has_span_ = true;
        }
    }
    void end_span() {
        if (!has_span_) return;
        has_span_ = false;
        put_span(span_);
    }
    void put_span(const Span& span) {
        Trace::Figures figures{{{"records", span.records}}};
        std::size_t i = 1;
        if (batch_ != kNoBatch) figures[i++] = {"batch", batch_};
        if (span.append_s > 0) figures[i] = {"append_ns", static_cast<std::int64_t>(span.append_s * 1e9)};
        lane_->span(kStageNames[static_cast<std::size_t>(span.stage)], span.begin_s, span.end_s, figures);
    }

    RoundReport& round() {
        const std::size_t i = round_ + ahead_;
        if (i >= rounds_.size()) rounds_.resize(i + 1);
        return rounds_[i];
    }

    bool is_on_;
    double mark_s_ = 0;
    double within_s_ = 0;  ///< of the stage under way, that belongs to others
    std::size_t round_ = 0;
    std::size_t ahead_ = 0;
    std::vector<RoundReport> rounds_;

    Trace* trace_;
    int thread_;
    Trace::Lane* lane_ = nullptr;  ///< null unless traced; all that follows is for it
    double round_begin_s_ = 0;
    std::int64_t traced_rounds_ = 0;
    RoundReport traced_;  ///< the round under way
    std::int64_t batch_ = kNoBatch;
    Span span_{};
    bool has_span_ = false;
};

}  // namespace raypool::wavefront
