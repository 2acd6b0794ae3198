// Every struct is taken apart by a structured binding, so that a member that is added there does not compile here
// until it is hashed too.

#include "core/scene/scene_hash.h"

#include <cstddef>
#include <map>
#include <memory>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <xxhash.h>

namespace raypool {

namespace {

/// Of meshes with normals: before triangles were smooth, normals were hashed and changed no image.
constexpr int kSmooth = 1;
/// Of instances, which are rounded where they stand, and not before.
constexpr int kInstance = 2;

class Hasher {
  public:
    Hasher() { XXH3_64bits_reset(state_.get()); }
    [[nodiscard]] std::string digest() const { return fmt::format("{:016x}", XXH3_64bits_digest(state_.get())); }

    template <class... Parts>
    void add_all(const Parts&... parts) {
        (add(parts), ...);
    }

  private:
    template <class Number>
    requires(std::is_arithmetic_v<Number> || std::is_enum_v<Number>) void add(const Number& number) {
        XXH3_64bits_update(state_.get(), &number, sizeof(number));
    }
    void add(const Vector3d& vector) { XXH3_64bits_update(state_.get(), vector.data(), 3 * sizeof(double)); }
    void add(const CameraDescription& camera) {
        const auto& [from, at, up, fov, defocus, focus, open, close] = camera;
        add_all(from, at, up, fov, defocus, focus, open, close);
    }
    void add(const Background& background) {
        const auto& [bottom, top, image, rotation, scale] = background;
        add_all(bottom, top);
        if (image) add_all(image, rotation, scale);
    }
    void add(const std::shared_ptr<const Image>& image) {
        if (!image) return add(0);
        const auto& [width, height, rgb] = *image;
        add_all(static_cast<int>(width), static_cast<int>(height), rgb);
    }
    void add(const Texture& texture) {
        const auto& [kind, even, odd, scale, offset, image, wrap] = texture;
        add_all(kind, even, odd, scale, offset, image);
        if (image) add(wrap);
    }
    void add(const Material& material) {
        const auto& [kind, texture_id, fuzz, ior, strength, front_only] = material;
        add_all(kind, texture_id, fuzz, ior);
        if (strength != 1 || front_only) add_all(strength, front_only);
    }
    void add(const Sphere& sphere) {
        const auto& [center0, center1, radius, material_id] = sphere;
        add_all(center0, center1, radius, material_id);
    }
    void add(const Quad& quad) {
        const auto& [corner, edge_u, edge_v, material_id] = quad;
        add_all(corner, edge_u, edge_v, material_id);
    }
    void add(const Plane& plane) {
        const auto& [point, normal, material_id, quads_before] = plane;
        add_all(point, normal, material_id, quads_before);
    }
    template <class T, std::size_t count>
    void add(const std::array<T, count>& elements) {
        for (const T& element : elements) add(element);
    }
    void add(const Mesh& mesh) {
        const auto& [positions, normals, uv, triangles] = mesh;
        add_all(positions, normals, uv, triangles);
    }
    void add(const MeshShape& shape) {
        const auto& [mesh, transform, material_id, is_instance] = shape;
        if (is_instance) {
            const auto [found, is_new] = objects_.try_emplace(mesh.get(), objects_.size());
            add_all(kInstance, found->second, material_id);
            if (is_new) add(*mesh);
        } else {
            add(*mesh);
            add(material_id);
            if (!mesh->normals.empty()) add(kSmooth);
        }
        for (int i = 0; i < 12; ++i) add(transform(i / 4, i % 4));
    }
    template <class T>
    void add(const std::vector<T>& elements) {
        add(elements.size());
        for (const T& element : elements) add(element);
    }

    struct Free {
        void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
    };
    std::unique_ptr<XXH3_state_t, Free> state_{XXH3_createState()};
    std::map<const Mesh*, std::size_t> objects_;  ///< those with instances, in order
};

}  // namespace

std::string scene_hash(const Scene& scene) {
    const auto& [name, description, width, height, camera, background, textures, materials, spheres, quads, planes,
                 meshes] = scene;
    Hasher hasher;
    hasher.add_all(width, height, camera, background, textures, materials, spheres, quads, planes);
    if (!meshes.empty()) hasher.add_all(meshes);
    return hasher.digest();
}

}  // namespace raypool
