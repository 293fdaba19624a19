// OBJ statements, and faces into indexed meshes.
#include "host/scene/obj_reader.hpp"

#include <array>
#include <charconv>
#include <deque>
#include <limits>
#include <optional>
#include <unordered_map>

#include "host/base/error.hpp"
#include "host/base/spelling.hpp"
#include "host/scene/mesh_tools.hpp"
#include "host/scene/notes.hpp"
#include "host/scene/obj_materials.hpp"
#include "host/scene/text_cursor.hpp"
#include "host/scene/triangulate.hpp"

namespace hemiray {

namespace {

// A face's corner: 0-based indices, -1 where absent.
struct Corner {
  std::int64_t v = -1;
  std::int64_t vt = -1;
  std::int64_t vn = -1;
  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t h = static_cast<std::uint64_t>(c.v) * 0x9E3779B97F4A7C15ULL;
    h = (h ^ (h >> 29) ^ static_cast<std::uint64_t>(c.vt)) * 0xBF58476D1CE4E5B9ULL;
    h = (h ^ (h >> 32) ^ static_cast<std::uint64_t>(c.vn)) * 0x94D049BB133111EBULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};

// One o/g group while it grows.
struct Group {
  Mesh mesh;
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertices;
  bool has_normals = false;
  bool has_uvs = false;
};

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& file, const FileResolver& resolve)
      : cursor_(text, file, TextCursor::Syntax::obj), materials_(scene_, file, resolve, notes_) {}

  Scene parse() {
    while (cursor_.next_line()) statement(cursor_.token());
    for (Group& group : groups_) finish(group);
    if (scene_.objects.empty()) notes_.once(cursor_.file() + ": holds no faces");
    scene_.notes = notes_.lines();
    return std::move(scene_);
  }

 private:
  void statement(std::string_view key) {
    if (key == "v") return vertex();
    if (key == "vt") return texture_coordinate();
    if (key == "vn") return normal();
    if (key == "f" || key == "fo") return face();
    if (key == "o") return select_group(cursor_.rest(), {});
    if (key == "g") return select_group(object_name_, cursor_.rest());
    if (key == "usemtl") return use_material();
    if (key == "mtllib") return material_library();
    if (key == "s") {
      const std::string_view group = cursor_.token();
      smooth_ = group != "off" && group != "0";
      return;
    }
    if (key == "l" || key == "p") return note("lines and points ('" + std::string(key) + "') are ignored");
    note("'" + printable(key) + "' is not supported, ignored");
  }

  void note(const std::string& text) { notes_.once(cursor_.file() + ": " + text); }

  void vertex() {
    std::array<float, 7> values{};
    std::size_t count = 0;
    while (count < values.size() && !cursor_.at_line_end()) values[count++] = cursor_.number_f("v");
    cursor_.expect_line_end();
    if (count < 3 || count == 5) {
      cursor_.fail("v: needs x y z, x y z w, or x y z r g b, not " + std::to_string(count) + " numbers");
    }
    if (count == 4 && values[3] != 1.0F) note("vertex weights (v x y z w) are ignored");
    positions_.emplace_back(values[0], values[1], values[2]);
    if (count < 6) {
      if (!colors_.empty()) colors_.emplace_back(1.0F);
      return;
    }
    const Vec3 rgb(values[3], values[4], values[5]);
    const Vec3 color = glm::clamp(rgb, Vec3(0.0F), Vec3(1.0F));
    if (color != rgb) note("vertex colours outside [0,1] are clamped");
    materials_.set_vertex_colors();
    colors_.resize(positions_.size(), Vec3(1.0F));
    colors_.back() = color;
  }

  void texture_coordinate() {
    const float u = cursor_.number_f("vt");
    const float v = cursor_.at_line_end() ? 0.0F : cursor_.number_f("vt");
    if (!cursor_.at_line_end()) cursor_.number_f("vt");
    cursor_.expect_line_end();
    uvs_.emplace_back(u, 1.0F - v);  // OBJ counts v upwards from the bottom row
  }

  void normal() {
    DVec3 n(0.0);
    for (int i = 0; i < 3; ++i) n[i] = cursor_.number("vn");
    cursor_.expect_line_end();
    normals_.push_back(normalized_or_zero(n));
  }

  // One index of a corner: 1-based, or negative and counted back from the latest.
  std::int64_t index(std::string_view digits, std::size_t count, std::string_view what) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
      cursor_.fail_at(digits, "f: '" + printable(digits) + "' is not an index; write v, v/vt, v//vn or v/vt/vn");
    }
    if (error == std::errc{} && value == 0) cursor_.fail_at(digits, "f: index 0; indices start at 1");
    const auto available = static_cast<std::int64_t>(count);
    if (error != std::errc{} || value > available || value < -available) {
      cursor_.fail_at(digits, "f: " + std::string(what) + " " + printable(digits) + " does not exist; there are " +
                                  std::to_string(count) + " before this line");
    }
    return value > 0 ? value - 1 : available + value;
  }

  Corner corner(std::string_view token) const {
    Corner result;
    const std::size_t first = token.find('/');
    result.v = index(token.substr(0, first), positions_.size(), "vertex");
    if (first == std::string_view::npos) return result;
    const std::string_view tail = token.substr(first + 1);
    const std::size_t second = tail.find('/');
    const std::string_view vt = tail.substr(0, second);
    if (!vt.empty() || second == std::string_view::npos) result.vt = index(vt, uvs_.size(), "texture coordinate");
    if (second != std::string_view::npos) result.vn = index(tail.substr(second + 1), normals_.size(), "normal");
    return result;
  }

  void face() {
    corners_.clear();
    points_.clear();
    triangles_.clear();
    while (!cursor_.at_line_end()) {
      if (corners_.size() == kMaxFaceCorners) {
        cursor_.fail("f: more than " + std::to_string(kMaxFaceCorners) + " corners; split the face");
      }
      corners_.push_back(corner(cursor_.token()));
      points_.push_back(positions_[static_cast<std::size_t>(corners_.back().v)]);
    }
    if (corners_.size() < 3) cursor_.fail("f: a face needs at least 3 corners");
    scene_.dropped_triangles += triangulate(points_, triangles_);
    if (triangles_.empty()) return;
    Group& group = current_group();
    if (!material_) material_ = material_name_ ? materials_.use(*material_name_) : materials_.default_index();
    if (group.mesh.triangles.size() + triangles_.size() > std::numeric_limits<std::uint32_t>::max() / 3) {
      cursor_.fail("the group has too many triangles; split it");
    }
    for (const std::array<std::uint32_t, 3>& t : triangles_) {
      // Braces, because they are evaluated from left to right.
      group.mesh.triangles.push_back(
          UVec3{add(group, corners_[t[0]]), add(group, corners_[t[1]]), add(group, corners_[t[2]])});
      group.mesh.triangle_materials.push_back(*material_);
    }
  }

  std::uint32_t add(Group& group, const Corner& corner) {
    const auto next = static_cast<std::uint32_t>(group.mesh.positions.size());
    const auto [at, fresh] = group.vertices.try_emplace(corner, next);
    if (!fresh) return at->second;
    Mesh& mesh = group.mesh;
    const auto v = static_cast<std::size_t>(corner.v);
    mesh.positions.push_back(positions_[v]);
    mesh.uvs.push_back(corner.vt < 0 ? Vec2(0.0F) : uvs_[static_cast<std::size_t>(corner.vt)]);
    mesh.normals.push_back(corner.vn < 0 ? Vec3(0.0F) : normals_[static_cast<std::size_t>(corner.vn)]);
    if (v < colors_.size()) {
      mesh.colors.resize(next, Vec3(1.0F));
      mesh.colors.push_back(colors_[v]);
    } else if (!mesh.colors.empty()) {
      mesh.colors.emplace_back(1.0F);
    }
    group.has_uvs = group.has_uvs || corner.vt >= 0;
    group.has_normals = group.has_normals || corner.vn >= 0;
    if (corner.vn < 0 && smooth_) note("smoothing groups ('s') are ignored: faces without vn are flat");
    return next;
  }

  void select_group(std::string_view object, std::string_view group) {
    object_name_ = std::string(object);
    group_name_ = std::string(group);
    group_ = nullptr;
  }

  Group& current_group() {
    if (group_ != nullptr) return *group_;
    const std::string key = object_name_ + '\n' + group_name_;
    const auto [at, fresh] = group_of_name_.try_emplace(key, groups_.size());
    if (fresh) {
      groups_.emplace_back();
      const bool both = !object_name_.empty() && !group_name_.empty();
      groups_.back().mesh.name = object_name_ + (both ? "/" : "") + group_name_;
      if (groups_.back().mesh.name.empty()) groups_.back().mesh.name = "default";
    }
    group_ = &groups_[at->second];
    return *group_;
  }

  void use_material() {
    material_name_ = std::string(cursor_.rest());
    if (material_name_->empty()) cursor_.fail("usemtl: a name is missing");
    material_.reset();
  }

  void material_library() {
    const std::string names(cursor_.rest());
    if (names.empty()) cursor_.fail("mtllib: a file name is missing");
    materials_.add_libraries(names, cursor_.place());
  }

  void finish(Group& group) {
    if (!group.has_normals) group.mesh.normals.clear();
    if (!group.has_uvs) group.mesh.uvs.clear();
    mark_rectangle(group.mesh);
    Object object;
    object.name = group.mesh.name;
    object.mesh = static_cast<std::uint32_t>(scene_.meshes.size());
    scene_.meshes.push_back(std::move(group.mesh));
    scene_.objects.push_back(std::move(object));
    group.vertices.clear();
  }

  Scene scene_;
  Notes notes_;
  TextCursor cursor_;
  ObjMaterials materials_;
  std::vector<Vec3> positions_;
  std::vector<Vec3> normals_;
  std::vector<Vec2> uvs_;
  std::vector<Vec3> colors_;  // up to the last coloured vertex
  std::deque<Group> groups_;  // a deque, because group_ points into it
  std::unordered_map<std::string, std::size_t> group_of_name_;
  Group* group_ = nullptr;
  std::string object_name_;
  std::string group_name_;
  std::optional<std::string> material_name_;
  std::optional<std::uint32_t> material_;
  bool smooth_ = false;
  std::vector<Corner> corners_;  // of the face at hand; kept to spare allocations
  std::vector<Vec3> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

Scene read_obj(std::string_view text, const std::string& file, const FileResolver& resolve) {
  return ObjParser(text, file, resolve).parse();
}

Scene load_obj(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = read_file(file);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Scene scene = read_obj(text, file.string(), folder_resolver(file.parent_path()));
  scene.source = file;
  scene.title = file.stem().string();
  return scene;
}

}  // namespace hemiray
