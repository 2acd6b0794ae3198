#include "core/runtime/engine.h"

#include <algorithm>

#include "core/base/error.h"

namespace raypool {

void RenderReport::add(const RenderReport& later) {
    seconds += later.seconds;
    setup_s += later.setup_s;
    add_each<ThreadReport>(threads, later.threads);
    statistics.add(later.statistics);
    memory_bytes = std::max(memory_bytes, later.memory_bytes);
    if (later.engine == nullptr) return;
    if (engine == nullptr) {
        engine = later.engine;
    } else {
        if (engine.use_count() > 1) engine = engine->copy();
        engine->add(*later.engine);
    }
}

RenderReport render_whole(RenderSession& session, const RenderSettings& settings) {
    session.add({settings.first_sample, settings.end_sample, settings.pixels});
    return session.finish();
}

void refuse_double() {
    throw InputError("--precision double: this build has none; configure it with -DRAYPOOL_BUILD_DOUBLE=ON");
}

}  // namespace raypool
