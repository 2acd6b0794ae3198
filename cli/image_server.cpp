#include "cli/image_server.h"

#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool::cli {

namespace {

// The kinds of messages that are sent (tev, IpcPacket; pbrt-v4, display.cpp).
constexpr char kUpdateImage = 3;
constexpr char kCreateImage = 4;

constexpr const char* kChannels[] = {"R", "G", "B"};
constexpr int kSeconds = 10;  // to wait for the other side

/// Numbers are little endian, texts end in a zero, and the length of all stands in front.
class Message {
  public:
    explicit Message(char kind) : bytes_(sizeof(std::int32_t)) { bytes_.push_back(kind); }
    void put_flag(bool flag) { bytes_.push_back(flag ? 1 : 0); }
    void put(std::int64_t number) { put_bits(static_cast<std::uint32_t>(number)); }
    void put(const std::string& text) { bytes_.insert(bytes_.end(), text.c_str(), text.c_str() + text.size() + 1); }
    void put(float number) { put_bits(std::bit_cast<std::uint32_t>(number)); }
    std::vector<char> whole() {
        const auto length = static_cast<std::uint32_t>(bytes_.size());
        for (unsigned i = 0; i < 4; ++i) bytes_[i] = static_cast<char>(length >> 8 * i & 0xffU);
        return std::move(bytes_);
    }

  private:
    void put_bits(std::uint32_t bits) {
        for (unsigned i = 0; i < 4; ++i) bytes_.push_back(static_cast<char>(bits >> 8 * i & 0xffU));
    }
    std::vector<char> bytes_;
};

[[noreturn]] void refuse(const std::string& place, const std::string& why) {
    throw InputError(fmt::format("--display-server: {}: {}", place, why));
}

std::string reason(int error) {
    return std::generic_category().message(error);
}

/// A socket that is connected, or -1 with errno set.
int connected(const addrinfo& address) {
    const int found = socket(address.ai_family, address.ai_socktype, address.ai_protocol);
    if (found < 0) return -1;
    const timeval limit{kSeconds, 0};
    setsockopt(found, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof(limit));  // of connect() too
    if (connect(found, address.ai_addr, address.ai_addrlen) == 0) return found;
    const int error = errno == EINPROGRESS ? ETIMEDOUT : errno;
    close(found);
    errno = error;
    return -1;
}

}  // namespace

ImageServer::ImageServer(const std::string& place) {
    const std::size_t colon = place.rfind(':');
    if (colon == std::string::npos || colon == 0 || colon + 1 == place.size())
        refuse(place, "must be HOST:PORT, such as localhost:14158");
    std::string host = place.substr(0, colon);
    if (host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);

    addrinfo wanted{};
    wanted.ai_family = AF_UNSPEC;
    wanted.ai_socktype = SOCK_STREAM;
    addrinfo* first = nullptr;
    const int failed = getaddrinfo(host.c_str(), place.c_str() + colon + 1, &wanted, &first);
    if (failed != 0) refuse(place, failed == EAI_SYSTEM ? reason(errno) : gai_strerror(failed));
    const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(first, freeaddrinfo);
    for (const addrinfo* address = first; address != nullptr && socket_ < 0; address = address->ai_next)
        socket_ = connected(*address);
    if (socket_ < 0) refuse(place, reason(errno));
}

ImageServer::~ImageServer() {
    close(socket_);
}

void ImageServer::send_message(const std::vector<char>& message) const {
    for (std::size_t sent = 0; sent < message.size();) {
        const ssize_t count = send(socket_, message.data() + sent, message.size() - sent, MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw std::runtime_error(reason(errno == EAGAIN ? ETIMEDOUT : errno));
        sent += static_cast<std::size_t>(count);
    }
}

void ImageServer::create(const std::string& name, std::int64_t width, std::int64_t height) {
    name_ = name;
    Message message(kCreateImage);
    message.put_flag(true);  // bring it to the front
    message.put(name_);
    message.put(width);
    message.put(height);
    message.put(std::int64_t{std::size(kChannels)});
    for (const char* channel : kChannels) message.put(std::string(channel));
    send_message(message.whole());
}

void ImageServer::update(const Image& image) {
    constexpr std::int64_t kMostValues = 1 << 20;  // of a message
    const std::int64_t rows = std::max<std::int64_t>(1, kMostValues / image.width);
    for (std::int64_t y = 0; y < image.height; y += rows) {
        const std::int64_t height = std::min(rows, image.height - y);
        for (std::size_t k = 0; k < std::size(kChannels); ++k) {
            Message message(kUpdateImage);
            message.put_flag(false);
            message.put(name_);
            message.put(std::string(kChannels[k]));
            message.put(std::int64_t{0});
            message.put(y);
            message.put(image.width);
            message.put(height);
            for (std::int64_t i = y * image.width; i < (y + height) * image.width; ++i)
                message.put(image.rgb[static_cast<std::size_t>(3 * i) + k]);
            send_message(message.whole());
        }
    }
}

}  // namespace raypool::cli
