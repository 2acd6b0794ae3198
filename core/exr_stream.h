/// Bytes in memory as the stream that OpenEXR reads from, with some of them hidden from it; called by exr_header.cpp
/// and exr_codec.cpp.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/image_codecs.h"

namespace raypool {

using StreamPosition = decltype(std::declval<Imf::OStream&>().tellp());  // its type changed in version 3

class MemoryInput final : public Imf::IStream {
  public:
    /// A byte at a place in `hidden` (ascending) is read as '?'; both must outlive this.
    MemoryInput(BytesView bytes, std::span<const std::size_t> hidden)
        : IStream("the file"), bytes_(bytes), hidden_(hidden) {}

    bool read(char target[], int size) override {
        if (position_ > bytes_.size() || static_cast<std::size_t>(size) > bytes_.size() - position_) {
            throw std::runtime_error("the file ends too early");
        }
        std::memcpy(target, bytes_.data() + position_, static_cast<std::size_t>(size));
        const std::size_t end = position_ + static_cast<std::size_t>(size);
        for (auto place = std::lower_bound(hidden_.begin(), hidden_.end(), position_);
             place != hidden_.end() && *place < end; ++place) {
            target[*place - position_] = '?';
        }
        position_ = end;
        return position_ < bytes_.size();
    }
    StreamPosition tellg() override { return position_; }
    void seekg(StreamPosition position) override { position_ = position; }

  private:
    BytesView bytes_;
    std::span<const std::size_t> hidden_;
    std::size_t position_ = 0;
};

}  // namespace raypool
