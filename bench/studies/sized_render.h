/// What the study scene-size renders: a generated scene by an engine whose pools have a size.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "bench/studies/generated_scene.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "wavefront/capacity.h"
#include "wavefront/pool_report.h"

namespace raypool::studies {

/// Before the name of a way, and a comma: what was counted of it.
inline constexpr const char* kCounted = "cache misses";

/// A generated scene, made when it is wanted.
struct SizedScene {
    std::string kind;
    std::int64_t shapes;
    std::int64_t width;
    Lazy<std::shared_ptr<const StudyScene>> get;

    SizedScene(const std::string& of_kind, std::int64_t of_shapes, std::int64_t wide)
        : kind(of_kind),
          shapes(of_shapes),
          width(wide),
          get([=] { return generated_scene(of_kind, of_shapes, wide); }) {}
};

/// An engine, by how large its pools are; recursion and peers have none.
struct SizedWay {
    std::string name;
    std::optional<wavefront::PoolSettings> pool;
    std::shared_ptr<const Engine> peer = nullptr;

    [[nodiscard]] NamedEngine engine() const {
        if (peer != nullptr) return {name, peer};
        return pool ? pool_engine("pool", *pool) : recursive_engine();
    }
};

/// What a case renders.
struct SizedRender {
    SizedWay way;
    std::shared_ptr<SizedScene> scene;
    RenderSettings settings;

    [[nodiscard]] Render get() const { return {way.engine(), scene->get(), settings}; }
    /// What every row says; `way_text` begins with what was counted, if anything was.
    [[nodiscard]] Cells cells(const std::string& way_text, const Measured& measured) const {
        const RenderReport& report = measured.report;
        return render_cells(get(), measured) +
               Cells{{"kind", scene->kind},
                     {"shapes", scene->shapes},
                     {"depth", settings.depth},
                     {"way", way_text},
                     {"capacity", way.pool ? Value(wavefront::pool_report(report).pool_rays) : Value()},
                     {"tree_bytes", wavefront::tree_bytes(scene->get()->compiled)},
                     {"segments", report.segments()},
                     {"ns_per_segment", ns_per_segment(report, settings.threads)}};
    }
    /// The row's time is not used: counting takes some.
    [[nodiscard]] Cells miss_cells(const Measured& measured, const char* source, const Value& d1_read_misses,
                                   const Value& ll_read_misses) const {
        return cells(fmt::format("{}, {}", kCounted, way.name), measured) +
               Cells{{"source", source}, {"d1_read_misses", d1_read_misses}, {"ll_read_misses", ll_read_misses}};
    }
};

}  // namespace raypool::studies
