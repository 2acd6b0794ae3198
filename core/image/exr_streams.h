/// OpenEXR's streams over bytes in memory.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/image/image_codecs.h"

namespace raypool {

using StreamPosition = decltype(std::declval<Imf::OStream&>().tellp());  // its type changed in version 3

class MemoryOutput final : public Imf::OStream {
  public:
    MemoryOutput() : OStream("the file") {}

    void write(const char data[], int size) override {
        const std::size_t end = position_ + static_cast<std::size_t>(size);
        if (end > bytes.size()) bytes.resize(end);
        std::memcpy(bytes.data() + position_, data, static_cast<std::size_t>(size));
        position_ = end;
    }
    StreamPosition tellp() override { return position_; }
    void seekp(StreamPosition position) override { position_ = position; }

    Bytes bytes;

  private:
    std::size_t position_ = 0;
};

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
