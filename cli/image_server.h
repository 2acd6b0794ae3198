/// A program that shows images as they come: tev (https://github.com/Tom94/tev), by the protocol that pbrt-v4 speaks to
/// it too.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image/image.h"

namespace raypool::cli {

/// A connection, held while it lives. Not synchronised.
class ImageServer {
  public:
    /// HOST:PORT, or [HOST]:PORT of an address with colons. Throws InputError, naming --display-server, where none
    /// answers within ten seconds.
    explicit ImageServer(const std::string& place);
    ImageServer(const ImageServer&) = delete;
    ImageServer& operator=(const ImageServer&) = delete;
    ~ImageServer();

    /// Opens an image under the name, of three channels; what is sent goes to it.
    void create(const std::string& name, std::int64_t width, std::int64_t height);
    /// All pixels anew. Throws std::runtime_error where the other side is gone.
    void update(const Image& image);

  private:
    void send_message(const std::vector<char>& message) const;

    int socket_ = -1;
    std::string name_;
};

}  // namespace raypool::cli
