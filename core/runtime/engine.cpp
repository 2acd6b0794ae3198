#include "core/runtime/engine.h"

#include <algorithm>

#include "core/base/error.h"

namespace raypool {

void RenderReport::add(const RenderReport& later) {
    seconds += later.seconds;
    setup_s += later.setup_s;
    add_each<ThreadReport>(threads, later.threads);
    add_each<ListLevel>(lists, later.lists);
    statistics.add(later.statistics);
    rounds.insert(rounds.end(), later.rounds.begin(), later.rounds.end());
    record_bytes = std::max(record_bytes, later.record_bytes);
    pool_rays = std::max(pool_rays, later.pool_rays);
    pool_bytes = std::max(pool_bytes, later.pool_bytes);
}

RenderReport render_whole(RenderSession& session, const RenderSettings& settings) {
    session.add({settings.first_sample, settings.end_sample, settings.pixels});
    return session.finish();
}

void check_settings(const RenderSettings& settings, const Framebuffer& framebuffer) {
    if (framebuffer.has_squares() && settings.split_depth > 0)
        throw InputError(
            "--split-depth: a sample that splits reaches its pixel in parts, so its square, which --target-error "
            "needs, is not known");
}

void refuse_double() {
    throw InputError("--precision double: this build has none; configure it with -DRAYPOOL_BUILD_DOUBLE=ON");
}

}  // namespace raypool
