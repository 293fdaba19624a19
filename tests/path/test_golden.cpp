// Pictures that every device must repeat to the bit (--strict). docs/ci.md tells how to make them anew.
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

#include "host/base/exr.hpp"
#include "host/path/render.hpp"
#include "host/scene/load.hpp"

namespace hemiray {
namespace {

std::size_t differing_values(const Layer& a, const Layer& b) {
  REQUIRE(a.data.size() == b.data.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.data.size(); i++) {
    count += std::bit_cast<std::uint32_t>(a.data[i]) != std::bit_cast<std::uint32_t>(b.data[i]) ? 1 : 0;
  }
  return count;
}

void check_golden(const std::string& name, const std::string& scene_file) {
  const std::string root = HR_SOURCE_DIR;
  const Image golden = read_exr(root + "/tests/golden/" + name + ".exr");
  const Scene scene = load_scene(root + "/scenes/" + scene_file);
  RenderOptions options;
  options.strict = true;
  options.width = golden.width;
  options.height = golden.height;
  options.spp = 1;
  Context context(choose_device(""));
  const Image image = render_scene(context, scene, options).image;
  REQUIRE(image.layers.size() == golden.layers.size());
  for (const Layer& layer : image.layers) {
    const auto same = std::find_if(golden.layers.begin(), golden.layers.end(),
                                   [&](const Layer& other) { return other.name == layer.name; });
    REQUIRE(same != golden.layers.end());
    INFO(name << ", layer '" << layer.name << "'");
    CHECK(differing_values(layer, *same) == 0);
  }
}

}  // namespace

TEST_CASE("tiny: a strict picture of glass, mirrors and textures has the golden bits") {
  check_golden("glass_and_mirror", "glass_and_mirror.json");
}

TEST_CASE("tiny: a strict picture of highlights and point lights has the golden bits") {
  check_golden("phong_source", "phong_source.json");
}

TEST_CASE("tiny: a strict picture under an area light has the golden bits") {
  check_golden("cornell_box", "cornell_box.json");
}

TEST_CASE("tiny: a strict picture of disks, cylinders, cones and quadrics has the golden bits") {
  check_golden("analytic_shapes", "analytic_shapes.json");
}

TEST_CASE("a strict picture of implicit surfaces has the golden bits") {
  check_golden("implicit_surfaces", "implicit_surfaces.json");
}

}  // namespace hemiray
