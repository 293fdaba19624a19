// MTL keywords, and the mapping from MTL's illumination models to hemiray's materials.
#include "host/scene/mtl_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/spelling.hpp"
#include "host/scene/mesh_tools.hpp"
#include "host/scene/text_cursor.hpp"

namespace hemiray {

namespace {

class MtlParser {
 public:
  MtlParser(std::string_view text, const std::string& file, Notes& notes)
      : cursor_(text, file, TextCursor::Syntax::obj), notes_(notes) {}

  std::vector<MtlMaterial> parse() {
    while (cursor_.next_line()) statement(cursor_.token());
    return std::move(materials_);
  }

 private:
  void statement(std::string_view key) {
    if (key == "newmtl") return new_material();
    if (key.starts_with("map_") || key == "bump" || key == "disp" || key == "decal" || key == "norm" || key == "refl") {
      return map(key);
    }
    static constexpr std::array<std::string_view, 10> kNumeric = {"Kd", "Ks", "Ka", "Ke", "Tf",
                                                                  "Ns", "Ni", "d",  "Tr", "illum"};
    if (std::find(kNumeric.begin(), kNumeric.end(), key) == kNumeric.end()) {
      notes_.once(cursor_.file() + ": '" + printable(key) + "' is not supported, ignored");
      return;
    }
    MtlMaterial& material = current();
    if (key == "Kd") material.kd = reflectance(key);
    if (key == "Ks") material.ks = reflectance(key);
    if (key == "Ka") material.ka = reflectance(key);
    if (key == "Tf") material.tf = reflectance(key);
    if (key == "Ke") material.ke = color(key);
    if (key == "Ns") material.ns = bounded(key, 0.0F, 1e9F);
    if (key == "Ni") material.ni = bounded(key, 0.001F, 1000.0F);
    if (key == "d") material.dissolve = dissolve();
    if (key == "Tr") material.transparency = bounded(key, 0.0F, 1.0F);
    if (key == "illum") material.illum = static_cast<int>(cursor_.integer(key, 0, 10));
    cursor_.expect_line_end();
  }

  void new_material() {
    const std::string_view name = cursor_.rest();
    if (name.empty()) cursor_.fail("newmtl: a name is missing");
    materials_.emplace_back();
    materials_.back().name = std::string(name);
    materials_.back().place = cursor_.place();
  }

  MtlMaterial& current() {
    if (materials_.empty()) cursor_.fail("stands before the first newmtl; add a newmtl line above it");
    return materials_.back();
  }

  // r [g b]: a single number is a grey.
  Vec3 color(std::string_view key) {
    Vec3 rgb(0.0F);
    for (int i = 0; i < 3; ++i) {
      if (i == 1 && cursor_.at_line_end()) return Vec3(rgb.x);
      rgb[i] = cursor_.number_f(key);
      if (rgb[i] < 0.0F) cursor_.fail(std::string(key) + ": a colour cannot be negative");
    }
    return rgb;
  }

  Vec3 reflectance(std::string_view key) {
    const Vec3 rgb = color(key);
    const Vec3 clamped = glm::min(rgb, Vec3(1.0F));
    if (clamped != rgb) notes_.once(cursor_.file() + ": " + std::string(key) + " above 1 is taken as 1");
    return clamped;
  }

  float bounded(std::string_view key, float low, float high) {
    const float value = cursor_.number_f(key);
    if (value < low || value > high) {
      cursor_.fail(std::string(key) + ": must lie between " + std::to_string(low) + " and " + std::to_string(high));
    }
    return value;
  }

  float dissolve() {
    const std::string_view first = cursor_.token();
    double value = 0.0;
    if (first == "-halo") {
      notes_.once(cursor_.file() + ": 'd -halo' is taken as plain 'd'");
      value = cursor_.number("d");
    } else {
      value = cursor_.parse_number(first, "d");
    }
    if (value < 0.0 || value > 1.0) cursor_.fail("d: must lie between 0 and 1");
    return static_cast<float>(value);
  }

  void map(std::string_view key) {
    const bool used = key == "map_Kd" || key == "map_Ke";
    if (!used) {
      notes_.once(cursor_.file() + ": '" + printable(key) + "' is not supported, ignored");
      return;
    }
    MtlMaterial& material = current();
    MtlMap map;
    std::string_view name = cursor_.rest();
    while (name.starts_with("-")) name = option(name, map);
    if (name.empty()) cursor_.fail(std::string(key) + ": a file name is missing");
    map.file = std::string(name);
    std::replace(map.file.begin(), map.file.end(), '\\', '/');
    map.place = cursor_.place();
    (key == "map_Kd" ? material.map_kd : material.map_ke) = map;
  }

  // Takes one "-option arguments" off the front of a map statement.
  std::string_view option(std::string_view line, MtlMap& map) {
    const auto word = [&line] {
      const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
      const std::string_view taken = line.substr(0, end);
      line.remove_prefix(std::min(line.find_first_not_of(" \t", end), line.size()));
      return taken;
    };
    const auto is_number = [](std::string_view text) {
      return !text.empty() && text.find_first_not_of("+-.0123456789eE") == std::string_view::npos;
    };
    const std::string_view name = word();
    if (name == "-clamp") {
      map.clamp = word() == "on";
      return line;
    }
    int arguments = 1;
    if (name == "-mm") arguments = 2;
    if (name == "-o" || name == "-s" || name == "-t") arguments = 3;
    static constexpr std::array<std::string_view, 10> kKnown = {"-mm",     "-o",  "-s",     "-t",       "-blendu",
                                                                "-blendv", "-cc", "-boost", "-imfchan", "-texres"};
    if (std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end()) {
      cursor_.fail_at(name, "unknown texture option '" + printable(name) + "'; remove it");
    }
    notes_.once(cursor_.file() + ": texture option '" + std::string(name) + "' is not supported, ignored");
    word();
    for (int i = 1; i < arguments; ++i) {
      const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
      if (!is_number(line.substr(0, end))) break;
      word();
    }
    return line;
  }

  TextCursor cursor_;
  Notes& notes_;
  std::vector<MtlMaterial> materials_;
};

// 1 - d, or Tr.
float transparency_of(const MtlMaterial& mtl, Notes& notes) {
  if (mtl.dissolve && mtl.transparency && std::abs(1.0F - *mtl.dissolve - *mtl.transparency) > 1e-3F) {
    notes.once(mtl.place + ": material '" + printable(mtl.name) + "': d and Tr contradict each other, d is used");
  }
  if (mtl.dissolve) return 1.0F - *mtl.dissolve;
  return mtl.transparency.value_or(0.0F);
}

// Refractive models. Tf is what passes the whole body, which has two interfaces.
void make_glass(const MtlMaterial& mtl, int illum, float transparency, Material& material) {
  const Vec3 ks = mtl.ks.value_or(Vec3(0.0F));
  const Vec3 body = mtl.tf.value_or(Vec3(transparency > 0.0F ? transparency : 1.0F));
  material.kt = glm::sqrt(body);
  material.fresnel = illum == 7;
  material.ks = Vec3(0.0F);
  if (illum == 4 || illum == 6) material.kr = ks;
  if (illum == 7 && !(mtl.ks && ks == Vec3(0.0F))) {
    // Fresnel scales kr only where light passes; a body that lets none through keeps the reflectance at normal
    // incidence.
    material.kr = Vec3(body == Vec3(0.0F) ? normal_reflectance(material.ior) : 1.0F);
  }
  if (illum == 9) material.ks = ks;
}

}  // namespace

std::vector<MtlMaterial> read_mtl(std::string_view text, const std::string& file, Notes& notes) {
  return MtlParser(text, file, notes).parse();
}

Material to_material(const MtlMaterial& mtl, Notes& notes) {
  Material material;
  material.name = mtl.name;
  material.kd = mtl.kd.value_or(mtl.map_kd ? Vec3(1.0F) : material.kd);
  material.ka = mtl.ka;
  material.shininess = mtl.ns.value_or(material.shininess);
  material.ior = mtl.ni.value_or(material.ior);
  material.emission = mtl.ke.value_or(Vec3(mtl.map_ke ? 1.0F : 0.0F));
  const Vec3 ks = mtl.ks.value_or(Vec3(0.0F));
  const float transparency = transparency_of(mtl, notes);
  const int illum = mtl.illum.value_or(mtl.ks ? 2 : 1);
  switch (illum) {
    case 0:
    case 1:
      break;
    case 10:
      notes.once(mtl.place + ": material '" + printable(mtl.name) + "': illum 10 (shadow catcher) is taken as illum 2");
      [[fallthrough]];
    case 2:
      material.ks = ks;
      break;
    case 3:
    case 5:
    case 8:
      material.kr = ks;  // the mirror shows the lights itself; a highlight from ks would count them twice
      material.fresnel = false;
      break;
    default:
      make_glass(mtl, illum, transparency, material);
      return material;
  }
  if (transparency > 0.0F) {
    const float opaque = 1.0F - transparency;
    material.kt = Vec3(transparency);
    material.ior = 1.0F;
    material.fresnel = false;
    material.kd *= opaque;
    material.ks *= opaque;
    material.kr *= opaque;
  }
  return material;
}

}  // namespace hemiray
