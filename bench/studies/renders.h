/// Renders as cases of a study: one engine, one setting, timed, with the figures that every study wants of a render.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/studies/study.h"
#include "core/runtime/engine.h"
#include "core/shading/compiled_scene.h"
#include "wavefront/settings.h"

namespace raypool::studies {

/// A scene at the size of a study, compiled once and shared by its cases.
struct StudyScene {
    std::string name;
    CompiledScene<float> compiled;
};
/// Throws InputError for a scene that cannot be read or a width that cannot be.
std::shared_ptr<const StudyScene> study_scene(const std::string& name, std::int64_t width);

/// A value that is dear to make, made when it is first asked for: a study is planned more often than it is run.
template <class T>
class Lazy {
  public:
    explicit Lazy(std::function<T()> make) : make_(std::move(make)) {}
    const T& operator()() {
        if (!made_) made_.emplace(make_());
        return *made_;
    }

  private:
    std::function<T()> make_;
    std::optional<T> made_;
};

/// An engine under the name that tables show.
struct NamedEngine {
    std::string name;
    std::shared_ptr<const Engine> engine;
};
NamedEngine recursive_engine();
NamedEngine iterative_engine();
/// The default of the wavefront engine: the fastest pool.
NamedEngine fused_pool();
/// The paper's pool, for all threads, with wide stages and streams.
NamedEngine canonical_pool();
/// The pool of a rung of the ladder (wavefront/ladder.h) for so many threads. A name that is none is a bug.
wavefront::PoolSettings rung_settings(const std::string& rung, int threads);
NamedEngine pool_engine(std::string name, const wavefront::PoolSettings& pool);
/// Facts of a study (study.h) that shows rungs: "rungs", the name of each and what is different from the one before.
nlohmann::json rung_facts();

/// A way of handing out the image, by the texts that users write.
struct LoopWay {
    const char* name;
    const char* grain;
    const char* schedule;
};
RenderSettings with_way(RenderSettings settings, const LoopWay& way);

/// What most studies take from the options.
struct Plan {
    RenderSettings settings;  ///< samples, depth (50 unless another is asked for) and seed
    int repeats = 1;
    int most_threads = 1;
};
Plan plan_of(const StudyOptions& options, Usual spp, Usual repeats, int most_threads);

struct Measured {
    RenderReport report;
    std::string hash;
    std::shared_ptr<const Framebuffer> image;
};
/// Throws InputError unless OpenMP gave as many threads as were asked for: a row of fewer would be of another
/// experiment.
void check_threads(int given, int asked);
/// One render. What fixes its threads is checked.
Measured measure(const Engine& engine, const StudyScene& scene, const RenderSettings& settings);

/// One render: by whom, of what, and how.
struct Render {
    NamedEngine engine;
    std::shared_ptr<const StudyScene> scene;
    RenderSettings settings;
};
inline Measured measure(const Render& render) {
    return measure(*render.engine.engine, *render.scene, render.settings);
}

/// The columns of a render, and `more` behind them: engine, threads, schedule and grain (of engines that loop over the
/// image), width, seconds, mpaths_per_s, load_max_over_mean, waiting, hash.
std::vector<Column> render_columns(const std::vector<Column>& more);
Cells render_cells(const Render& render, const Measured& measured);

/// The schedule and grain of an engine that loops over the image; nothing of others.
Cells loop_cells(bool loops_over_image, const RenderSettings& settings);

/// A case of one render, whose rows are made by rows(render).
Case case_of(std::string id, const Render& render, int repeats,
             const std::function<std::vector<Cells>(const Render& render)>& rows);
/// Cells of a row that stand behind those of every render: the same for all repeats, or taken from what a render did.
using MoreCells = std::function<Cells(const RenderReport& report)>;
/// A case of one row: render_cells() and `more`.
Case render_case(std::string id, const Render& render, int repeats, const MoreCells& more);
Case render_case(std::string id, const Render& render, int repeats, const Cells& more);

/// 1, 2, 4, ... up to `most`, and `most` itself.
std::vector<int> thread_counts(int most);
/// 1 and `most`.
std::vector<int> one_and_all(int most);
/// Threads that can run at once here.
int core_count();

}  // namespace raypool::studies
