// Implicit surfaces in pictures: they look like the same surfaces by other means, and what is open is reported.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "host/bvh/ray_queries.hpp"
#include "host/path/render.hpp"
#include "host/scene/expression.hpp"
#include "host/scene/features.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

constexpr int kSize = 48;

Shape& add_implicit(Scene& scene, const std::string& text, std::uint32_t material) {
  Shape& shape = scene.shapes.emplace_back();
  shape.kind = ShapeKind::implicit;
  shape.expression = parse_expression(text, {{"r", 0.8}});
  shape.material = material;
  shape.clip = Clip::sphere;
  shape.clip_radius = 1.2;
  return shape;
}

Scene room() {
  Scene scene = reference::empty_scene({0, 1.5, 5}, {0, 0.2, 0}, 40.0);
  reference::add_plane(scene, {0, -0.9, 0}, {0, 1, 0}, reference::add_material(scene, reference::diffuse(Vec3(0.6F))));
  reference::add_point_light(scene, {2, 5, 4}, Vec3(30.0F));
  scene.background = Vec3(0.3F);
  return scene;
}

RenderResult render(const Scene& scene, EngineKind engine = EngineKind::wavefront) {
  RenderOptions options;
  options.width = options.height = kSize;
  options.spp = 1;
  options.depth = 4;
  options.engine = engine;
  options.strict = true;
  Context context(choose_device(""));
  return render_scene(context, scene, options);
}

}  // namespace

TEST_CASE("implicit surfaces: a ball is the ball that a sphere is, diffuse and of glass") {
  for (const bool clear : {false, true}) {
    Scene implicit = room(), sphere = room();
    const Material material = clear ? reference::glass(1.5F) : reference::diffuse(Vec3(0.7F));
    add_implicit(implicit, "x^2 + y^2 + z^2 - r^2", reference::add_material(implicit, material));
    reference::add_sphere(sphere, {0, 0, 0}, 0.8, reference::add_material(sphere, material));
    const RenderResult wavefront = render(implicit), megakernel = render(implicit, EngineKind::megakernel);
    const RenderResult expected = render(sphere);
    CHECK(wavefront.statistics.uncertain_roots == 0);
    int different = 0;
    for (int y = 0; y < kSize; y++) {
      for (int x = 0; x < kSize; x++) {
        double ours = 0.0, other = 0.0, theirs = 0.0;
        for (const char* layer : {"direct", "reflection", "refraction"}) {
          if (!clear && layer != std::string("direct")) continue;
          ours += reference::value_at(wavefront.image, layer, x, y);
          other += reference::value_at(megakernel.image, layer, x, y);
          theirs += reference::value_at(expected.image, layer, x, y);
        }
        CHECK(ours == other);
        if (std::abs(ours - theirs) > 1e-3 * (1.0 + std::abs(theirs))) different++;
      }
    }
    INFO((clear ? "glass: " : "diffuse: ") << different << " pixels differ");
    CHECK(different <= 4);  // at silhouettes, where one root more or less decides
  }
}

TEST_CASE("implicit surfaces: a power is the surface of its base, seen without doubt") {
  Scene once = room(), often = room();
  const auto add = [](Scene& scene, const std::string& text) {
    add_implicit(scene, text, reference::add_material(scene, reference::diffuse(Vec3(0.7F))));
  };
  add(once, "x^2 + y^2 + z^2 - r^2");
  add(often, "2*(x^2 + y^2 + z^2 - r^2)^4");
  const RenderResult result = render(often), expected = render(once);
  CHECK(result.statistics.uncertain_roots == 0);
  for (int y = 0; y < kSize; y++) {
    for (int x = 0; x < kSize; x++) {
      REQUIRE(reference::value_at(result.image, "direct", x, y) == reference::value_at(expected.image, "direct", x, y));
    }
  }
}

TEST_CASE("implicit surfaces: roots that stay open are counted where the user sees it") {
  Scene scene = room();
  // The square of a sphere's polynomial, in a form that does not show it.
  add_implicit(scene, "(x^2 + y^2 + z^2)^2 - 2*r^2*(x^2 + y^2 + z^2) + r^4",
               reference::add_material(scene, reference::diffuse(Vec3(0.7F))));
  const RenderResult result = render(scene);
  CHECK(result.statistics.uncertain_roots > 100);  // every ray at it touches it twice
  CHECK(has_feature(result.statistics.features, HR_FEATURE_IMPLICITS));
}

// A plane, turned by 60 degrees, in a clip that cuts it, looked at along z: an ellipse or a parallelogram.
TEST_CASE("implicit surfaces: their clip cuts them from any distance as from nearby") {
  for (const Clip clip : {Clip::sphere, Clip::box}) {
    Scene scene = reference::empty_scene({0, 0, 5}, {0, 0, 0}, 40.0);
    Shape& shape = add_implicit(scene, "x", reference::add_material(scene, reference::diffuse(Vec3(0.7F))));
    shape.clip = clip;
    shape.clip_radius = 1.0;
    shape.clip_half = DVec3(1.0);
    const double sine = std::sqrt(0.75), cosine = 0.5;
    shape.to_world = DMat4({cosine, 0, -sine, 0}, {0, 1, 0, 0}, {sine, 0, cosine, 0}, {0, 0, 0, 1});
    const FlatScene flat = flatten_scene(scene);
    Context context(choose_device(""));
    Parallel parallel(context);
    AccelBuilder builder(context, parallel);
    const DeviceScene device_scene(context, flat, features_of(scene, flat, 0));
    const Accel accel(builder, device_scene);
    RayQueries queries(context, device_scene, accel);
    for (const double distance : {3.0, 1e3, 1e5, 1e7}) {
      std::vector<shared::QueryRay> rays;
      std::vector<bool> inside;
      for (int i = -40; i <= 40; i++) {
        for (int j = -40; j <= 40; j++) {
          const double x = 0.0317 * i, y = 0.0317 * j, along = std::abs(x) / sine;
          const double edge = clip == Clip::sphere ? std::hypot(along, y) : std::max(along, std::abs(y));
          if (std::abs(edge - 1.0) < 1e-4) continue;  // the clip is taken a little wider
          rays.push_back({{static_cast<float>(x), static_cast<float>(y), static_cast<float>(distance), 0.0F},
                          {0.0F, 0.0F, -1.0F, std::numeric_limits<float>::infinity()}});
          inside.push_back(edge < 1.0);
        }
      }
      const std::vector<shared::QueryHit> hits = queries.intersect(rays);
      std::size_t missed = 0, invented = 0;
      for (std::size_t k = 0; k < hits.size(); k++) {
        const bool hit = hits[k].primitive != HR_NO_PRIMITIVE;
        missed += inside[k] && !hit;
        invented += !inside[k] && hit;
      }
      CAPTURE(static_cast<int>(clip), distance);
      CHECK(missed == 0);
      CHECK(invented == 0);
      CHECK(device_scene.uncertain_roots() == 0);
    }
  }
}

}  // namespace hemiray
