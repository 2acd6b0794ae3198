#include "bench/accuracy/reference.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <xxhash.h>

#include "core/base/error.h"
#include "core/scene/scene_hash.h"

namespace raypool::accuracy {

namespace fs = std::filesystem;

Reference::Reference(std::shared_ptr<const SceneInBoth> scene, std::int64_t half_spp, fs::path folder, int threads,
                     const Configuration& configuration)
    : scene_(std::move(scene)),
      half_spp_(half_spp),
      folder_(std::move(folder)),
      threads_(threads),
      configuration_(configuration) {}

const std::string& Reference::key() {
    if (key_.empty()) {
        const std::string first = render_image(configuration_, *scene_, {0, 1, kReferenceSeeds[0], threads_}).hash;
        const std::string text =
            fmt::format("{} {} samples {} seeds {:x} {:x} first {}", scene_hash(scene_->description),
                        to_string(configuration_), half_spp_, kReferenceSeeds[0], kReferenceSeeds[1], first);
        key_ = fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
    }
    return key_;
}

fs::path Reference::file(std::size_t half) {
    return folder_ / fmt::format("{}-{}x{}-{}-{}.sums", scene_->description.name, scene_->in_double.width,
                                 scene_->in_double.height, key(), half == 0 ? 'a' : 'b');
}

void Reference::open() {
    if (!halves_.empty()) return;
    const FixedPoint fixed = fixed_point(configuration_, *scene_, half_spp_);
    for (std::size_t i = 0; i < kReferenceSeeds.size(); ++i)
        halves_.push_back({{{"reference", key()}, {"half", i == 0 ? "a" : "b"}},
                           half_spp_,
                           {},
                           {},
                           0,
                           Framebuffer(scene_->in_double.width, scene_->in_double.height, fixed)});
    if (folder_.empty()) return;
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) throw InputError(fmt::format("{}: cannot make the folder: {}", folder_.string(), error.message()));
    for (std::size_t i = 0; i < halves_.size(); ++i)
        if (fs::exists(file(i))) load(i);
}

void Reference::load(std::size_t half) {
    try {
        Checkpoint found = read_checkpoint(file(half));
        check_same_render(found, halves_[half]);
        if (found.ranges != std::vector<SampleRange>{{0, found.sample_count()}} || found.sample_count() > half_spp_)
            throw InputError("its samples are not the first ones");
        halves_[half] = std::move(found);
    } catch (const InputError& error) {
        const std::string why = error.what();
        const std::string place = why.starts_with(file(half).string()) ? "" : file(half).string() + ": ";
        throw InputError(fmt::format("{}{}; remove it, and it is rendered again", place, why));
    }
}

std::int64_t Reference::extend(std::int64_t more) {
    open();
    const std::size_t half = halves_[1].sample_count() < halves_[0].sample_count() ? 1 : 0;
    Checkpoint& sums = halves_[half];
    const SampleRange next{sums.sample_count(), std::min(sums.sample_count() + more, half_spp_)};
    if (next.first < next.end) {
        render_into(sums.framebuffer, configuration_, *scene_, {next.first, next.end, kReferenceSeeds[half], threads_});
        sums.ranges = with_range(std::move(sums.ranges), next);
        if (!folder_.empty()) write_checkpoint(file(half), sums);
    }
    return 2 * half_spp_ - halves_[0].sample_count() - halves_[1].sample_count();
}

const Halves& Reference::halves() {
    constexpr std::int64_t kRange = 256;
    if (!means_) {
        while (extend(kRange) > 0) {
        }
        means_ = {channel_means(halves_[0].framebuffer, half_spp_), channel_means(halves_[1].framebuffer, half_spp_)};
    }
    return *means_;
}

}  // namespace raypool::accuracy
