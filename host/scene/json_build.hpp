// What the readers of one JSON scene share while they fill it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "host/scene/json_values.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// Where the contents of a mesh file stand in the scene, so that a second object of the same file shares them.
struct MergedFile {
  std::vector<Object> objects;  ///< as the file places them, indices already those of the scene
  bool has_uvs = true;          ///< every mesh has texture coordinates
};

struct JsonBuild {
  Scene scene;
  std::filesystem::path folder;  ///< external files are relative to it; empty: none are read
  std::map<std::string, std::uint32_t, std::less<>> materials;
  std::map<std::string, int> textures;  ///< by file and settings
  std::map<std::string, MergedFile> mesh_files;
  std::optional<std::uint32_t> default_material;
};

/// The file a string names, relative to the scene's folder. Throws InputError where it does not exist, or where the
/// scene is not allowed to read files.
std::filesystem::path read_file_path(const JsonNode& node, const JsonBuild& build);

/// Fills build.scene.materials and .textures from the "materials" object.
void read_materials(const JsonNode& node, JsonBuild& build);

/// The material an object names under "material", or the default one (kd 0.5) where it names none.
std::uint32_t read_material_of(const JsonNode& object, JsonBuild& build);

/// Whether any texture hangs on the material.
bool has_texture(const Material& material);

/// Appends one element of "objects" to the scene.
void read_object(const JsonNode& node, JsonBuild& build);

/// Appends an object of "type": "mesh" (in host/scene/json_mesh.cpp).
void read_mesh_object(const JsonNode& node, JsonBuild& build);

/// Appends an object of type "disk", "cylinder", "cone" or "quadric" (in host/scene/json_shape.cpp).
void read_shape_object(const JsonNode& node, std::string_view type, JsonBuild& build);

/// Throws InputError if the material an object names has a texture, which objects of that kind cannot show.
void refuse_textures(const JsonNode& object, const Material& material, std::string_view kind);

/// Reads "name" if there.
std::string read_name(const JsonNode& node);

/// One element of "lights".
Light read_light(const JsonNode& node);

/// The "camera" object; sets Scene::camera and, where it is placed, has_camera.
void read_camera(const JsonNode& node, Scene& scene);

}  // namespace hemiray
