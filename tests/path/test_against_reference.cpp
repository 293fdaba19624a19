// The renderer against the independent reference tracer, layer by layer, on small images of every feature.
#include <catch2/catch.hpp>

#include "tests/path/render_on_device.hpp"
#include "tests/reference/comparison_scenes.hpp"
#include "tests/reference/image_agreement.hpp"

namespace hemiray {

namespace {

// Float against double: a pixel changes outright only where a ray passes an edge (of a shape, a shadow, a texel) within
// a few float ulps. Moving the reference's own camera by 10 ulps changes up to 0.43 % of the pixels of a layer where
// the camera looks exactly along the edges of a box, 0.07 % elsewhere.
constexpr double kOutlierShare = 0.01;

// All other pixels: the same movement gives a relMSE of up to 4e-8 (glass 50 m from the origin); float's own errors
// over several bounces come on top. A systematic error of one part in a thousand in bright pixels gives 1e-6.
constexpr double kRelMse = 3e-7;

/// Compares scenes `first`, first + 3, ...: three cases an engine, so that none compiles all kernels by itself.
void check_every_third(EngineKind engine, std::size_t first) {
  const auto scenes = reference::comparison_scenes();
  REQUIRE(scenes.size() > 9);
  for (std::size_t i = first; i < scenes.size(); i += 3) {
    const auto& [name, scene, options] = scenes[i];
    const Image expected = render_reference(scene, options);
    const Image image = render_on_device(scene, options, engine);
    for (const reference::LayerAgreement& layer : reference::compare_layers(image, expected)) {
      INFO("scene '" << name << "', layer '" << layer.layer << "', seed " << options.seed);
      CHECK(layer.outlier_share <= kOutlierShare);
      CHECK(layer.rel_mse <= kRelMse);
    }
  }
}

}  // namespace

TEST_CASE("wavefront agrees with the reference tracer in every third scene from the first") {
  check_every_third(EngineKind::wavefront, 0);
}
TEST_CASE("wavefront agrees with the reference tracer in every third scene from the second") {
  check_every_third(EngineKind::wavefront, 1);
}
TEST_CASE("wavefront agrees with the reference tracer in every third scene from the third") {
  check_every_third(EngineKind::wavefront, 2);
}
TEST_CASE("megakernel agrees with the reference tracer in every third scene from the first") {
  check_every_third(EngineKind::megakernel, 0);
}
TEST_CASE("megakernel agrees with the reference tracer in every third scene from the second") {
  check_every_third(EngineKind::megakernel, 1);
}
TEST_CASE("megakernel agrees with the reference tracer in every third scene from the third") {
  check_every_third(EngineKind::megakernel, 2);
}

TEST_CASE("beauty is the sum of direct, reflection and refraction") {
  const reference::ComparisonScene item = reference::comparison_scenes().front();
  const Image image = render_on_device(item.scene, item.options);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double sum = reference::value_at(image, "direct", x, y, c) +
                           reference::value_at(image, "reflection", x, y, c) +
                           reference::value_at(image, "refraction", x, y, c);
        // Two float additions in another order.
        REQUIRE(reference::value_at(image, "", x, y, c) == Approx(sum).epsilon(1e-6).margin(1e-7));
      }
    }
  }
}

}  // namespace hemiray
