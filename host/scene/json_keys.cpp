// The key tables of the JSON scene format. A new key needs a line here, one in its reader, one in scene.schema.json and
// one in docs/scene-json.md.
#include "host/scene/json_keys.hpp"

#include <array>
#include <stdexcept>
#include <string>

namespace hemiray {
namespace {

constexpr bool kRequired = true;

constexpr auto kScene = std::to_array<JsonKey>({{"hemiray", kRequired},
                                                {"$schema"},
                                                {"title"},
                                                {"description"},
                                                {"camera"},
                                                {"background"},
                                                {"ambient"},
                                                {"shading"},
                                                {"depth"},
                                                {"emitter_samples"},
                                                {"materials"},
                                                {"objects"},
                                                {"lights"}});
constexpr auto kCamera =
    std::to_array<JsonKey>({{"position"}, {"look_at"}, {"up"}, {"fov"}, {"orthographic_height"}, {"size"}});
constexpr auto kMaterial = std::to_array<JsonKey>({{"kd"},
                                                   {"ka"},
                                                   {"ks"},
                                                   {"shininess"},
                                                   {"kr"},
                                                   {"kt"},
                                                   {"translucency"},
                                                   {"ior"},
                                                   {"fresnel"},
                                                   {"emission"},
                                                   {"kd_texture"},
                                                   {"emission_texture"},
                                                   {"normal_texture"},
                                                   {"normal_scale"},
                                                   {"base_color"},
                                                   {"base_color_texture"},
                                                   {"metallic"},
                                                   {"roughness"},
                                                   {"metallic_roughness_texture"}});
constexpr auto kTexture = std::to_array<JsonKey>({{"file", kRequired}, {"filter"}, {"wrap"}, {"color_space"}});
constexpr auto kTransform = std::to_array<JsonKey>({{"translate"}, {"rotate"}, {"scale"}, {"matrix"}});
constexpr auto kRotate = std::to_array<JsonKey>({{"axis", kRequired}, {"degrees", kRequired}});
constexpr auto kMesh = std::to_array<JsonKey>({{"type", kRequired},
                                               {"name"},
                                               {"file"},
                                               {"vertices"},
                                               {"triangles"},
                                               {"polygons"},
                                               {"normals"},
                                               {"uvs"},
                                               {"material"},
                                               {"transform"}});
constexpr auto kQuad = std::to_array<JsonKey>({{"type", kRequired},
                                               {"name"},
                                               {"corner"},
                                               {"edge_u"},
                                               {"edge_v"},
                                               {"vertices"},
                                               {"uv_scale"},
                                               {"material"},
                                               {"transform"}});
constexpr auto kPlane = std::to_array<JsonKey>(
    {{"type", kRequired}, {"name"}, {"point", kRequired}, {"normal", kRequired}, {"material"}, {"transform"}});
constexpr auto kSphere = std::to_array<JsonKey>(
    {{"type", kRequired}, {"name"}, {"center", kRequired}, {"radius", kRequired}, {"material"}, {"transform"}});
constexpr auto kDisk = std::to_array<JsonKey>({{"type", kRequired},
                                               {"name"},
                                               {"center", kRequired},
                                               {"normal", kRequired},
                                               {"radius", kRequired},
                                               {"material"},
                                               {"transform"}});
constexpr auto kCylinder = std::to_array<JsonKey>({{"type", kRequired},
                                                   {"name"},
                                                   {"from", kRequired},
                                                   {"to", kRequired},
                                                   {"radius", kRequired},
                                                   {"caps"},
                                                   {"material"},
                                                   {"transform"}});
constexpr auto kCone = std::to_array<JsonKey>({{"type", kRequired},
                                               {"name"},
                                               {"from", kRequired},
                                               {"to", kRequired},
                                               {"radius_from", kRequired},
                                               {"radius_to"},
                                               {"caps"},
                                               {"material"},
                                               {"transform"}});
constexpr auto kQuadric = std::to_array<JsonKey>(
    {{"type", kRequired}, {"name"}, {"coefficients", kRequired}, {"center"}, {"clip"}, {"material"}, {"transform"}});
constexpr auto kImplicit = std::to_array<JsonKey>({{"type", kRequired},
                                                   {"name"},
                                                   {"expression", kRequired},
                                                   {"constants"},
                                                   {"center"},
                                                   {"clip", kRequired},
                                                   {"material"},
                                                   {"transform"}});
constexpr auto kCoefficients =
    std::to_array<JsonKey>({{"x2"}, {"y2"}, {"z2"}, {"xy"}, {"yz"}, {"zx"}, {"x"}, {"y"}, {"z"}, {"1"}});
constexpr auto kClip = std::to_array<JsonKey>({{"box"}, {"sphere"}});
constexpr auto kClipBox = std::to_array<JsonKey>({{"min", kRequired}, {"max", kRequired}});
constexpr auto kClipSphere = std::to_array<JsonKey>({{"center"}, {"radius", kRequired}});
constexpr auto kBox = std::to_array<JsonKey>(
    {{"type", kRequired}, {"name"}, {"min", kRequired}, {"max", kRequired}, {"material"}, {"transform"}});
constexpr auto kPoint =
    std::to_array<JsonKey>({{"type", kRequired}, {"name"}, {"position", kRequired}, {"intensity", kRequired}});
constexpr auto kDirectional =
    std::to_array<JsonKey>({{"type", kRequired}, {"name"}, {"direction", kRequired}, {"irradiance", kRequired}});
constexpr auto kSpot = std::to_array<JsonKey>({{"type", kRequired},
                                               {"name"},
                                               {"position", kRequired},
                                               {"direction", kRequired},
                                               {"intensity", kRequired},
                                               {"inner_angle"},
                                               {"outer_angle"}});
constexpr auto kArea = std::to_array<JsonKey>({{"type", kRequired},
                                               {"name"},
                                               {"corner", kRequired},
                                               {"edge_u", kRequired},
                                               {"edge_v", kRequired},
                                               {"radiance", kRequired},
                                               {"samples"},
                                               {"jitter"},
                                               {"visible"}});

constexpr auto kTables = std::to_array<JsonKeyTable>({{"scene", kScene},
                                                      {"camera", kCamera},
                                                      {"material", kMaterial},
                                                      {"texture", kTexture},
                                                      {"transform", kTransform},
                                                      {"rotate", kRotate},
                                                      {"mesh", kMesh},
                                                      {"quad", kQuad},
                                                      {"plane", kPlane},
                                                      {"sphere", kSphere},
                                                      {"box", kBox},
                                                      {"disk", kDisk},
                                                      {"cylinder", kCylinder},
                                                      {"cone", kCone},
                                                      {"quadric", kQuadric},
                                                      {"implicit", kImplicit},
                                                      {"coefficients", kCoefficients},
                                                      {"clip", kClip},
                                                      {"clip_box", kClipBox},
                                                      {"clip_sphere", kClipSphere},
                                                      {"point", kPoint},
                                                      {"directional", kDirectional},
                                                      {"spot", kSpot},
                                                      {"area", kArea}});
constexpr auto kObjectTypes = std::to_array<std::string_view>(
    {"mesh", "quad", "plane", "sphere", "box", "disk", "cylinder", "cone", "quadric", "implicit"});
constexpr auto kLightTypes = std::to_array<std::string_view>({"point", "directional", "spot", "area"});

}  // namespace

std::span<const JsonKeyTable> json_key_tables() { return kTables; }

const JsonKeyTable& json_keys(std::string_view type) {
  for (const JsonKeyTable& table : kTables) {
    if (table.type == type) return table;
  }
  throw std::logic_error("no JSON key table for " + std::string(type));
}

std::span<const std::string_view> json_object_types() { return kObjectTypes; }
std::span<const std::string_view> json_light_types() { return kLightTypes; }

}  // namespace hemiray
