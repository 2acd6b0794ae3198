/// The tables of a scene in a device's memory.
#pragma once

#include <vector>

#include "gpu/device.h"

namespace raypool::gpu {

class DeviceScene {
  public:
    /// Copies all that `scene` sees.
    DeviceScene(Device& device, const SceneView<float>& scene) : view_(scene) {
        SceneView<float>::for_each_span(view_, [&]<class Row>(std::span<Row>& rows) {
            using Bytes = std::span<const std::byte>;
            const Bytes from = std::as_bytes(rows);
            const DeviceArray<std::byte>& copy = copies_.emplace_back(device, from);
            rows = {reinterpret_cast<Row*>(copy.data()), rows.size()};
        });
    }

    /// Points into the device's memory.
    [[nodiscard]] const SceneView<float>& view() const { return view_; }

    static std::size_t bytes(const SceneView<float>& scene) {
        std::size_t sum = 0;
        SceneView<float>::for_each_span(scene, [&](const auto& rows) { sum += rows.size_bytes(); });
        return sum;
    }

  private:
    SceneView<float> view_;
    std::vector<DeviceArray<std::byte>> copies_;
};

}  // namespace raypool::gpu
