// Triangles put together one by one into a FlatScene: what the procedural scenes and the leak meshes are made with.
#pragma once

#include <cstdint>
#include <random>

#include "host/base/vec.hpp"
#include "host/scene/flat_scene.hpp"

namespace hemiray::bench {

/// A FlatScene of triangles alone, of one grey material and one object.
class FlatMesh {
 public:
  FlatMesh() { flat_.materials.push_back(grey()); }

  /// Adds a vertex [m] and returns its index.
  std::uint32_t vertex(Vec3 p) {
    flat_.positions.insert(flat_.positions.end(), {p.x, p.y, p.z});
    return vertex_count() - 1;
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { flat_.triangles.push_back({a, b, c, 0}); }
  /// Two triangles with four vertices of their own.
  void quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d);
  /// A box of 12 triangles, turned about the vertical axis through its centre by `turn` [rad].
  void box(Vec3 center, Vec3 half_size, float turn);
  /// Two triangles for each cell between `rows` x `columns` vertices that were added row by row from `first` on.
  void grid(std::uint32_t first, std::uint32_t rows, std::uint32_t columns);

  [[nodiscard]] std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(flat_.positions.size() / 3); }
  [[nodiscard]] std::size_t triangle_count() const { return flat_.triangles.size(); }

  /// The scene; the mesh is used up.
  FlatScene take() &&;

 private:
  static shared::Material grey();
  FlatScene flat_;
};

/// Random numbers that are the same wherever the standard library is: the distributions of <random> are not.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : random_(seed) {}
  /// Evenly in [least, most].
  float in(float least, float most) { return least + (most - least) * unit(); }
  /// Evenly in [0, 1] (1 where 32 random bits round up to it).
  float unit() { return static_cast<float>(random_()) * 0x1p-32F; }
  /// True once in `n` times.
  bool one_in(std::uint32_t n) { return random_() % n == 0; }
  /// Below n.
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((random_() * std::uint64_t{n}) >> 32U); }

 private:
  std::mt19937 random_;
};

/// A vertex of the scene [m].
inline Vec3 vertex_of(const FlatScene& flat, std::uint32_t index) {
  const float* p = &flat.positions[std::size_t{3} * index];
  return {p[0], p[1], p[2]};
}

}  // namespace hemiray::bench
