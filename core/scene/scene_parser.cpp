#include "core/scene/scene_parser.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_parser.h"
#include "core/base/text.h"
#include "core/scene/camera_parser.h"
#include "core/scene/json_cursor.h"
#include "core/scene/lengths.h"
#include "core/scene/mesh_parser.h"
#include "core/scene/scene_images.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxRadiance = 1e6;
constexpr double kMaxRotationDegrees = 360;

/// Refuses what is multiplied by a factor beyond the range of radiance.
void check_brightest(const JsonCursor& place, double brightest) {
    if (brightest > kMaxRadiance) {
        place.refuse(fmt::format("leave the radiance within [0, {:g}]", kMaxRadiance),
                     fmt::format("one that reaches {:g}", brightest));
    }
}

Background image_background(const JsonCursor& file, JsonObject& object, SceneImages& images) {
    Background background;
    if (const auto rotation = object.optional("rotation_degrees")) {
        background.rotation_degrees = rotation->number(-kMaxRotationDegrees, kMaxRotationDegrees);
    }
    const auto scale = object.optional("scale");
    if (scale) background.scale = scale->number(1 / kMaxRadiance, kMaxRadiance);
    object.refuse_unknown_keys();
    background.image = images.environment(file);
    check_brightest(scale ? *scale : file, background.brightest());
    return background;
}

Background background(const JsonCursor& place, SceneImages& images) {
    if (place.is_array()) {
        const Vector3d radiance = place.vector3(0, kMaxRadiance);
        return {radiance, radiance};
    }
    if (!place.is_object()) place.refuse("be a colour [r, g, b] or an object with bottom and top, or with an image");
    JsonObject object(place);
    if (const auto image = object.optional("image")) return image_background(*image, object, images);
    Background gradient{object.required("bottom").vector3(0, kMaxRadiance),
                        object.required("top").vector3(0, kMaxRadiance)};
    object.refuse_unknown_keys();
    return gradient;
}

Texture texture(SceneImages& images, JsonObject object) {
    using Kind = Texture::Kind;
    Texture texture;
    const std::string type = object.required("type").one_of({"solid", "checker_3d", "checker_uv", "image"});
    if (type == "solid") {
        texture.kind = Kind::Solid;
        texture.even = object.required("color").vector3(0, kMaxRadiance);
    } else if (type == "image") {
        texture.kind = Kind::Image;
        texture.image = images.texture(object.required("file"));
        if (const auto wrap = object.optional("wrap")) {
            texture.wrap = wrap->one_of({"repeat", "clamp"}) == "repeat" ? Texture::Wrap::Repeat : Texture::Wrap::Clamp;
        }
    } else {
        texture.kind = type == "checker_3d" ? Kind::Checker3d : Kind::CheckerUv;
        texture.even = object.required("even").vector3(0, kMaxRadiance);
        texture.odd = object.required("odd").vector3(0, kMaxRadiance);
        texture.scale = object.required("scale").number(kMinLength, kMaxLength);
    }
    if (texture.kind == Kind::Checker3d) {
        if (const auto offset = object.optional("offset")) texture.offset = position(*offset);
    }
    object.refuse_unknown_keys();
    return texture;
}

/// Fills a Scene from the top of the document downwards, since later parts name earlier ones.
class SceneReader {
  public:
    explicit SceneReader(const fs::path& image_folder) : images_(image_folder) {}

    Scene read(const JsonCursor& root) {
        JsonObject object(root);
        if (const auto schema = object.optional("$schema")) schema->text();  // for editors
        scene_.description = object.required("description").text();
        if (const auto image = object.optional("image")) read_image_size(JsonObject(*image));
        scene_.camera = parse_camera(JsonObject(object.required("camera")));
        scene_.background = background(object.required("background"), images_);
        if (const auto textures = object.optional("textures")) {
            for (const auto& [name, place] : textures->members()) {
                texture_ids_[name] = add(texture(images_, JsonObject(place)));
            }
        }
        if (const auto materials = object.optional("materials")) {
            for (const auto& [name, place] : materials->members()) {
                material_ids_[name] = static_cast<std::int32_t>(scene_.materials.size());
                scene_.materials.push_back(material(JsonObject(place)));
            }
        }
        if (const auto objects = object.optional("objects")) {
            for (const auto& [name, place] : objects->members())
                objects_[name] = parse_object(JsonObject(place), images_);
        }
        const JsonCursor shapes = object.required("shapes");
        for (std::size_t i = 0; i < shapes.size(); ++i) read_shape(JsonObject(shapes.item(i)));
        object.refuse_unknown_keys();
        return std::move(scene_);
    }

  private:
    void read_image_size(JsonObject object) {
        constexpr std::int64_t kMaxPixels = 65536;  // along one side
        scene_.width = object.required("width").integer(1, kMaxPixels);
        scene_.height = object.required("height").integer(1, kMaxPixels);
        object.refuse_unknown_keys();
    }

    std::int32_t add(Texture texture) {
        scene_.textures.push_back(std::move(texture));
        return static_cast<std::int32_t>(scene_.textures.size()) - 1;
    }

    Material material(JsonObject object) {
        using Kind = Material::Kind;
        Material material;
        const std::string type = object.required("type").one_of({"diffuse", "metal", "dielectric", "emissive"});
        if (type == "dielectric") {
            material.kind = Kind::Dielectric;
            material.ior = object.required("ior").number(0.1, 10);
        } else if (type == "emissive") {
            material.kind = Kind::Emissive;
            read_emission(object, material);
        } else {
            material.kind = type == "metal" ? Kind::Metal : Kind::Diffuse;
            material.texture_id = texture_id(object.required("albedo"), 1);
        }
        if (material.kind == Kind::Metal) {
            if (const auto fuzz = object.optional("fuzz")) material.fuzz = fuzz->number(0, 1);
        }
        object.refuse_unknown_keys();
        return material;
    }

    void read_emission(JsonObject& object, Material& material) {
        material.texture_id = texture_id(object.required("radiance"), kMaxRadiance);
        if (const auto strength = object.optional("strength")) {
            material.strength = strength->number(1 / kMaxRadiance, kMaxRadiance);
            const Texture& texture = scene_.textures[static_cast<std::size_t>(material.texture_id)];
            check_brightest(*strength, material.strength * texture.brightest());
        }
        if (const auto sides = object.optional("sides"))
            material.front_only = sides->one_of({"both", "front"}) == "front";
    }

    /// A colour written in place, or a texture by its name.
    std::int32_t texture_id(const JsonCursor& place, double max_component) {
        if (place.is_array()) {
            Texture solid;
            solid.even = place.vector3(0, max_component);
            return add(std::move(solid));
        }
        if (!place.is_string()) place.refuse("be a colour [r, g, b] or the name of a texture");
        const auto named = texture_ids_.find(place.text());
        if (named == texture_ids_.end()) place.refuse("name a texture");
        const Texture& texture = scene_.textures[static_cast<std::size_t>(named->second)];
        if (texture.brightest() > max_component) {
            place.refuse(fmt::format("name a texture within [0, {:g}]", max_component),
                         fmt::format("one that reaches {:g}", texture.brightest()));
        }
        return named->second;
    }

    std::int32_t material_id(const JsonCursor& place) const {
        const auto named = material_ids_.find(place.text());
        if (named == material_ids_.end()) place.refuse("name a material");
        return named->second;
    }

    void read_shape(JsonObject object) {
        const std::string type = object.required("type").one_of({"sphere", "quad", "plane", "mesh", "instance"});
        if (type == "sphere") {
            Sphere sphere;
            sphere.center0 = position(object.required("center"));
            const auto center1 = object.optional("center1");
            sphere.center1 = center1 ? position(*center1) : sphere.center0;
            sphere.radius = object.required("radius").number(kMinLength, kMaxLength);
            sphere.material_id = material_id(object.required("material"));
            scene_.spheres.push_back(sphere);
        } else if (type == "quad") {
            Quad quad;
            quad.corner = position(object.required("corner"));
            quad.edge_u = direction(object.required("edge_u"));
            const JsonCursor edge_v = object.required("edge_v");
            quad.edge_v = direction(edge_v);
            if (are_parallel(quad.edge_u, quad.edge_v)) edge_v.refuse("not be parallel to edge_u", "a parallel edge");
            quad.material_id = material_id(object.required("material"));
            scene_.quads.push_back(quad);
        } else if (type == "mesh") {
            add_mesh(object, parse_mesh(object, images_));
        } else if (type == "instance") {
            const JsonCursor shape = object.required("shape");
            const auto named = objects_.find(shape.text());
            if (named == objects_.end()) shape.refuse("name one of the objects");
            shown_triangles_ += std::ssize(named->second.mesh->triangles);
            if (shown_triangles_ > kMaxShownTriangles) {
                shape.refuse(fmt::format("keep the triangles of all instances to {}", kMaxShownTriangles),
                             fmt::format("{} with this one", shown_triangles_));
            }
            add_mesh(object, parse_instance(object, named->second));
        } else {
            Plane plane;
            plane.point = position(object.required("point"));
            plane.normal = direction(object.required("normal"));
            plane.material_id = material_id(object.required("material"));
            plane.quads_before = std::ssize(scene_.quads);
            scene_.planes.push_back(plane);
        }
        object.refuse_unknown_keys();
    }

    void add_mesh(JsonObject& object, MeshShape shape) {
        const JsonCursor material = object.required("material");
        shape.material_id = material_id(material);
        const Material& made_of = scene_.materials[static_cast<std::size_t>(shape.material_id)];
        const bool is_coloured = made_of.kind != Material::Kind::Dielectric;
        if (shape.mesh->uv.empty() && is_coloured &&
            scene_.textures[static_cast<std::size_t>(made_of.texture_id)].needs_uv())
            material.refuse("name a material that needs no uv, or the mesh must have uv");
        scene_.meshes.push_back(std::move(shape));
    }

    SceneImages images_;
    Scene scene_;
    std::map<std::string, std::int32_t> texture_ids_;
    std::map<std::string, std::int32_t> material_ids_;
    std::map<std::string, MeshObject> objects_;
    std::int64_t shown_triangles_ = 0;
};

}  // namespace

Scene parse_scene(std::string_view json_text, const std::string& name_for_messages, const fs::path& texture_folder) {
    const nlohmann::json document = parse_json(json_text, name_for_messages);
    Scene scene = SceneReader(texture_folder).read(JsonCursor(document, name_for_messages));
    scene.name = valid_utf8(fs::path(name_for_messages).stem().string());
    return scene;
}

}  // namespace raypool
