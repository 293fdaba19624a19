#include "host/scene/instancing.hpp"

#include <algorithm>
#include <cmath>

#include "host/scene/emission.hpp"

namespace hemiray {
namespace {

// A mesh is shared if that saves this many triangles. A copy in the world's own tree is met faster, so a few thousand
// more are the better choice: they take a few hundred kilobytes, and no longer to build than a tree of the mesh's own.
constexpr std::size_t kLeastSaved = std::size_t{1} << 14U;

// Largest |L| |L^-1| of an instance's matrix (in the norm of largest row sums), by which errors grow on the way to the
// object and back: beyond, a copy in the world is more exact. And the largest of each by itself, far within what a
// float holds.
constexpr double kMostGrowth = 1e3;
constexpr double kMostScale = 1e12;

double norm(const glm::dmat3& m) {
  double most = 0.0;
  for (int row = 0; row < 3; row++) {
    most = std::max(most, std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]));
  }
  return most;
}

bool turns_back(const DMat4& to_world) {
  const glm::dmat3 linear(to_world);
  if (glm::determinant(linear) == 0.0) return false;
  const double there = norm(linear), back = norm(glm::inverse(linear));
  return there < kMostScale && back < kMostScale && there * back < kMostGrowth;
}

}  // namespace

std::vector<bool> instanced_objects(const Scene& scene, Instancing instancing) {
  std::vector<bool> instanced(scene.objects.size(), false);
  if (instancing == Instancing::never) return instanced;
  const std::vector<bool> emissive = emissive_objects(scene);
  std::vector<std::size_t> copies(scene.meshes.size(), 0);
  for (std::size_t i = 0; i < scene.objects.size(); i++) {
    const Object& object = scene.objects[i];
    if (scene.meshes[object.mesh].triangles.empty()) continue;
    instanced[i] = !emissive[i] && turns_back(object.to_world);
    if (instanced[i]) copies[object.mesh]++;
  }
  if (instancing == Instancing::always) return instanced;
  for (std::size_t i = 0; i < scene.objects.size(); i++) {
    const std::uint32_t mesh = scene.objects[i].mesh;
    const std::size_t saved = copies[mesh] == 0 ? 0 : (copies[mesh] - 1) * scene.meshes[mesh].triangles.size();
    instanced[i] = instanced[i] && saved >= kLeastSaved;
  }
  return instanced;
}

}  // namespace hemiray
