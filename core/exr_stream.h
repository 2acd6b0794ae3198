/// Bytes in memory as the stream that OpenEXR reads from; called by exr_header.cpp and exr_codec.cpp.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/image_codecs.h"

namespace raypool {

using StreamPosition = decltype(std::declval<Imf::OStream&>().tellp());  // its type changed in version 3

class MemoryInput final : public Imf::IStream {
  public:
    explicit MemoryInput(BytesView bytes) : IStream("the file"), bytes_(bytes) {}

    bool read(char target[], int size) override {
        if (position_ > bytes_.size() || static_cast<std::size_t>(size) > bytes_.size() - position_) {
            throw std::runtime_error("the file ends too early");
        }
        std::memcpy(target, bytes_.data() + position_, static_cast<std::size_t>(size));
        position_ += static_cast<std::size_t>(size);
        return position_ < bytes_.size();
    }
    StreamPosition tellg() override { return position_; }
    void seekg(StreamPosition position) override { position_ = position; }

  private:
    BytesView bytes_;
    std::size_t position_ = 0;
};

}  // namespace raypool
