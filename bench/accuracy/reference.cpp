// A file is a line of JSON, then the sums: 64-bit integers as this machine writes them.

#include "bench/accuracy/reference.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <xxhash.h>
#include <nlohmann/json.hpp>

#include "core/scene_hash.h"
#include "core/error.h"
#include "core/output_file.h"

namespace raypool::accuracy {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// All of a file's figures, so that a change of any shows.
json header_of(const std::string& key, std::size_t half, std::int64_t sample_count, const Framebuffer& framebuffer) {
    json header{{"key", key},
                {"half", half},
                {"samples", sample_count},
                {"width", framebuffer.width()},
                {"height", framebuffer.height()},
                {"fraction_bits", framebuffer.fixed_point().fraction_bits}};
    const std::string text = header.dump() + framebuffer.hash();
    header["checksum"] = fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
    return header;
}

}  // namespace

Reference::Reference(std::shared_ptr<const SceneInBoth> scene, std::int64_t half_spp, fs::path folder, int threads)
    : scene_(std::move(scene)), half_spp_(half_spp), folder_(std::move(folder)), threads_(threads) {}

const std::string& Reference::key() {
    if (key_.empty()) {
        const std::string first = render_image(kTrusted, *scene_, {0, 1, kReferenceSeeds[0], threads_}).hash;
        const std::string text =
            fmt::format("{} {} samples {} seeds {:x} {:x} first {}", scene_hash(scene_->description),
                        to_string(kTrusted), half_spp_, kReferenceSeeds[0], kReferenceSeeds[1], first);
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
    const FixedPoint fixed = FixedPoint::make(half_spp_, scene_->in_double.max_radiance);
    for (std::size_t i = 0; i < kReferenceSeeds.size(); ++i)
        halves_.push_back({Framebuffer(scene_->in_double.width, scene_->in_double.height, fixed)});
    if (folder_.empty()) return;
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) throw InputError(fmt::format("{}: cannot make the folder: {}", folder_.string(), error.message()));
    for (std::size_t i = 0; i < halves_.size(); ++i) load(i);
}

void Reference::load(std::size_t half) {
    const fs::path path = file(half);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) return;  // nothing is kept yet
    std::string line;
    std::getline(stream, line);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};

    Half& found = halves_[half];
    const std::span<std::int64_t> sums = found.framebuffer.sums();
    const json header = json::parse(line, nullptr, false);
    bool is_sound = header.is_object() && bytes.size() == sums.size_bytes();
    if (is_sound) {
        std::memcpy(sums.data(), bytes.data(), bytes.size());
        const json& samples = header.contains("samples") ? header["samples"] : json(0);
        found.sample_count = samples.is_number_integer() ? samples.get<std::int64_t>() : 0;
        is_sound = header == header_of(key_, half, found.sample_count, found.framebuffer);
    }
    if (!is_sound) throw InputError(fmt::format("{}: damaged; remove it, and it is rendered again", path.string()));
}

void Reference::save(std::size_t half) {
    if (folder_.empty()) return;
    const Half& h = halves_[half];
    const std::string header = header_of(key_, half, h.sample_count, h.framebuffer).dump() + "\n";
    const std::span<const std::byte> sums = std::as_bytes(h.framebuffer.sums());
    std::vector<std::byte> content(header.size());
    std::memcpy(content.data(), header.data(), header.size());
    content.insert(content.end(), sums.begin(), sums.end());
    write_whole(file(half), content);
}

std::int64_t Reference::extend(std::int64_t more) {
    open();
    const std::size_t half = halves_[1].sample_count < halves_[0].sample_count ? 1 : 0;
    Half& h = halves_[half];
    const std::int64_t end = std::min(h.sample_count + more, half_spp_);
    if (h.sample_count < end) {
        render_into(h.framebuffer, kTrusted, *scene_, {h.sample_count, end, kReferenceSeeds[half], threads_});
        h.sample_count = end;
        save(half);
    }
    return 2 * half_spp_ - halves_[0].sample_count - halves_[1].sample_count;
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
