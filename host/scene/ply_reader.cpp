// PLY elements into a mesh.
#include "host/scene/ply_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/read_file.hpp"
#include "host/base/spelling.hpp"
#include "host/scene/mesh_tools.hpp"
#include "host/scene/notes.hpp"
#include "host/scene/ply_header.hpp"
#include "host/scene/ply_values.hpp"
#include "host/scene/triangulate.hpp"

namespace hemiray {

namespace {

constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

// What a vertex property means; the order is that of the values read.
enum Slot : std::size_t { kX, kY, kZ, kNx, kNy, kNz, kU, kV, kRed, kGreen, kBlue, kSlots };

std::optional<std::size_t> slot_of(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Slot>, 15> kNames = {{{"x", kX},
                                                                                {"y", kY},
                                                                                {"z", kZ},
                                                                                {"nx", kNx},
                                                                                {"ny", kNy},
                                                                                {"nz", kNz},
                                                                                {"s", kU},
                                                                                {"t", kV},
                                                                                {"u", kU},
                                                                                {"v", kV},
                                                                                {"texture_u", kU},
                                                                                {"texture_v", kV},
                                                                                {"red", kRed},
                                                                                {"green", kGreen},
                                                                                {"blue", kBlue}}};
  for (const auto& [known, slot] : kNames) {
    if (name == known) return slot;
  }
  return std::nullopt;
}

class PlyParser {
 public:
  PlyParser(std::span<const std::uint8_t> bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  Scene parse() {
    TextCursor cursor({reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}, file_, TextCursor::Syntax::plain);
    const PlyHeader header = read_ply_header(cursor);
    PlyValues values(bytes_, header.format, cursor);
    for (const PlyElement& element : header.elements) {
      values.begin_element(element);
      if (element.name == "vertex") {
        read_vertices(element, values);
      } else if (element.name == "face") {
        read_faces(element, values);
      } else {
        skip_element(element, values);
      }
    }
    if (!has_vertices_) cursor.fail("the file has no element 'vertex'");
    return finish();
  }

 private:
  void skip_element(const PlyElement& element, PlyValues& values) {
    notes_.once(file_ + ": element '" + printable(element.name) + "' is not supported, ignored");
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values.begin_instance(i);
      for (const PlyProperty& property : element.properties) values.skip(property);
      values.end_instance();
    }
  }

  void read_vertices(const PlyElement& element, PlyValues& values) {
    constexpr std::size_t kNoSlot = kSlots;
    std::array<bool, kSlots + 1> given{};
    std::vector<std::size_t> slots;
    for (const PlyProperty& property : element.properties) {
      std::size_t slot = property.is_list ? kNoSlot : slot_of(property.name).value_or(kNoSlot);
      if (slot != kNoSlot && given[slot]) slot = kNoSlot;  // u beside s: the first counts
      if (slot == kNoSlot) note_ignored("vertex", property);
      given[slot] = true;
      slots.push_back(slot);
      if (slot == kRed) color_scale_ = color_scale(property.type);
    }
    if (!given[kX] || !given[kY] || !given[kZ]) throw InputError(element.place, "element 'vertex' needs x, y and z");
    const bool normals = given[kNx] && given[kNy] && given[kNz];
    const bool uvs = given[kU] && given[kV];
    const bool colors = given[kRed] && given[kGreen] && given[kBlue];
    if (element.count >= kUnused) throw InputError(element.place, "more than 4294967294 vertices");
    const auto count = static_cast<std::size_t>(element.count);
    mesh_.positions.reserve(count);
    if (normals) mesh_.normals.reserve(count);
    if (uvs) mesh_.uvs.reserve(count);
    if (colors) mesh_.colors.reserve(count);
    std::array<double, kSlots + 1> read{};
    for (std::size_t i = 0; i < count; ++i) {
      values.begin_instance(i);
      for (std::size_t p = 0; p < slots.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (slots[p] == kNoSlot) {
          values.skip(property);
        } else {
          read[slots[p]] = values.scalar(property.type);
        }
      }
      const Vec3 position(DVec3(read[kX], read[kY], read[kZ]));
      if (!is_finite(position)) {
        if (values.is_ascii()) values.fail("a coordinate is out of range");
        non_finite_ = true;
      }
      mesh_.positions.push_back(position);
      if (normals) mesh_.normals.push_back(normalized_or_zero(DVec3(read[kNx], read[kNy], read[kNz])));
      if (uvs) mesh_.uvs.push_back(texture_coordinate(read[kU], read[kV]));
      if (colors) mesh_.colors.push_back(Vec3(color(read[kRed]), color(read[kGreen]), color(read[kBlue])));
      values.end_instance();
    }
    has_vertices_ = true;
  }

  // Largest value of an integer colour; 0 for floats, which are linear already.
  static double color_scale(PlyType type) {
    if (type == PlyType::uint8 || type == PlyType::int8) return 255.0;
    return ply_is_integer(type) ? 65535.0 : 0.0;
  }

  float color(double value) {
    const double scaled = color_scale_ > 0.0 ? value / color_scale_ : value;
    if (!(scaled >= 0.0 && scaled <= 1.0)) notes_.once(file_ + ": vertex colours outside [0,1] are clamped");
    const auto clamped = std::isnan(scaled) ? 0.0F : static_cast<float>(std::clamp(scaled, 0.0, 1.0));
    return color_scale_ > 0.0 ? srgb_to_linear(clamped) : clamped;
  }

  Vec2 texture_coordinate(double u, double v) {
    const Vec2 uv(static_cast<float>(u), static_cast<float>(1.0 - v));  // PLY counts v upwards
    if (std::isfinite(uv.x) && std::isfinite(uv.y)) return uv;
    notes_.once(file_ + ": non-finite texture coordinates are taken as 0");
    return Vec2(0.0F);
  }

  void note_ignored(std::string_view element, const PlyProperty& property) {
    notes_.once(file_ + ": " + std::string(element) + " property '" + printable(property.name) +
                "' is not supported, ignored");
  }

  void read_faces(const PlyElement& element, PlyValues& values) {
    if (!has_vertices_) throw InputError(element.place, "element 'face' must stand behind element 'vertex'");
    std::size_t list = element.properties.size();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index")) {
        list = p;
      } else {
        note_ignored("face", property);
      }
    }
    if (list == element.properties.size()) {
      throw InputError(element.place, "element 'face' needs 'property list uchar int vertex_indices'");
    }
    if (!ply_is_integer(element.properties[list].type)) {
      throw InputError(element.place, "the list of vertex indices must have an integer type");
    }
    mesh_.triangles.reserve(static_cast<std::size_t>(element.count));
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values.begin_instance(i);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (p == list) {
          read_face(element.properties[p], values);
        } else {
          values.skip(element.properties[p]);
        }
      }
      values.end_instance();
    }
  }

  void read_face(const PlyProperty& property, PlyValues& values) {
    const std::uint64_t count = values.list_length(property);
    if (count < 3) values.fail("a face needs at least 3 corners");
    if (count > kMaxFaceCorners) {
      values.fail("more than " + std::to_string(kMaxFaceCorners) + " corners; split the face");
    }
    corners_.clear();
    points_.clear();
    triangles_.clear();
    bool finite = true;
    for (std::uint64_t k = 0; k < count; ++k) {
      const double index = values.scalar(property.type);
      if (index < 0.0 || index >= static_cast<double>(mesh_.positions.size())) {
        values.fail("vertex " + std::to_string(static_cast<std::int64_t>(index)) + " does not exist; there are " +
                    std::to_string(mesh_.positions.size()));
      }
      corners_.push_back(static_cast<std::uint32_t>(index));
      points_.push_back(mesh_.positions[corners_.back()]);
      finite = finite && is_finite(points_.back());
    }
    if (!finite) {
      dropped_ += count - 2;
      return;
    }
    dropped_ += triangulate(points_, triangles_);
    for (const std::array<std::uint32_t, 3>& t : triangles_) {
      mesh_.triangles.emplace_back(corners_[t[0]], corners_[t[1]], corners_[t[2]]);
    }
  }

  // Non-finite vertices are used by no triangle any more, but would still spoil the bounds.
  void remove_non_finite_vertices() {
    std::vector<std::uint32_t> moved(mesh_.positions.size(), kUnused);
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
      if (!is_finite(mesh_.positions[i])) continue;
      mesh_.positions[kept] = mesh_.positions[i];
      if (!mesh_.normals.empty()) mesh_.normals[kept] = mesh_.normals[i];
      if (!mesh_.uvs.empty()) mesh_.uvs[kept] = mesh_.uvs[i];
      if (!mesh_.colors.empty()) mesh_.colors[kept] = mesh_.colors[i];
      moved[i] = kept++;
    }
    mesh_.positions.resize(kept);
    if (!mesh_.normals.empty()) mesh_.normals.resize(kept);
    if (!mesh_.uvs.empty()) mesh_.uvs.resize(kept);
    if (!mesh_.colors.empty()) mesh_.colors.resize(kept);
    for (UVec3& triangle : mesh_.triangles) triangle = {moved[triangle.x], moved[triangle.y], moved[triangle.z]};
  }

  Scene finish() {
    if (non_finite_) remove_non_finite_vertices();
    Scene scene;
    scene.dropped_triangles = dropped_;
    if (mesh_.triangles.empty()) {
      notes_.once(file_ + ": holds no faces");
    } else {
      scene.materials.push_back(default_material(!mesh_.colors.empty()));
      mesh_.name = "ply";
      mesh_.triangle_materials.assign(mesh_.triangles.size(), 0);
      mark_rectangle(mesh_);
      scene.meshes.push_back(std::move(mesh_));
      scene.objects.emplace_back();
      scene.objects.back().name = scene.meshes.back().name;
    }
    scene.notes = notes_.lines();
    return scene;
  }

  std::span<const std::uint8_t> bytes_;
  const std::string& file_;
  Notes notes_;
  Mesh mesh_;
  bool has_vertices_ = false;
  bool non_finite_ = false;
  double color_scale_ = 0.0;
  std::uint64_t dropped_ = 0;
  std::vector<std::uint32_t> corners_;  // of the face at hand; kept to spare allocations
  std::vector<Vec3> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

Scene read_ply(std::span<const std::uint8_t> bytes, const std::string& file) { return PlyParser(bytes, file).parse(); }

Scene load_ply(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = read_file(file);
  Scene scene = read_ply(bytes, file.string());
  scene.source = file;
  scene.title = file.stem().string();
  for (Mesh& mesh : scene.meshes) mesh.name = scene.title;
  for (Object& object : scene.objects) object.name = scene.title;
  return scene;
}

}  // namespace hemiray
