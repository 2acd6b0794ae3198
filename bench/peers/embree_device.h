/// What Embree hands out, owned, and devices of so many threads.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace raypool::peers {

template <auto release>
struct Release {
    void operator()(auto handle) const { release(handle); }
};
template <class Handle, auto release>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release<release>>;

/// That builds with so many threads. Embree lets all devices have the most that any of them was told, so others must be
/// gone where fewer are meant. Throws std::runtime_error where there is none.
inline Owned<RTCDevice, rtcReleaseDevice> embree_device(int threads) {
    Owned<RTCDevice, rtcReleaseDevice> device(
        rtcNewDevice(("set_affinity=0,threads=" + std::to_string(threads)).c_str()));
    if (!device) throw std::runtime_error("Embree found no device");
    return device;
}

}  // namespace raypool::peers
