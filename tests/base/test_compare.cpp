// Image metrics against values worked out by hand.
#include "host/base/compare.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "host/base/error.hpp"

using hemiray::compare_images;
using hemiray::Image;
using hemiray::ImageComparison;
using hemiray::InputError;
using hemiray::Layer;

namespace {

// Sums of a few exactly representable terms, so only the last rounding differs.
constexpr double kRoundingEpsilon = 1e-12;

Image image_of(int width, int height, std::vector<Layer> layers) {
  Image image;
  image.width = width;
  image.height = height;
  image.layers = std::move(layers);
  return image;
}

Approx near(double value) { return Approx(value).epsilon(kRoundingEpsilon); }

}  // namespace

TEST_CASE("compare: RMSE, relMSE, PSNR and maximum of a small image") {
  const Image b = image_of(2, 1, {{"", {"R", "G", "B"}, {0, 1, 2, 4, 0, 1}}});
  const Image a = image_of(2, 1, {{"", {"R", "G", "B"}, {0.5F, 1, 1, 4, 0, 1}}});
  const ImageComparison result = compare_images(a, b, "a", "b");
  REQUIRE(result.layers.size() == 1);
  const auto& layer = result.layers[0];
  CHECK(layer.rmse == near(std::sqrt(1.25 / 6)));
  CHECK(layer.rel_mse == near((0.25 / 0.01 + 1.0 / 4.01) / 6));
  CHECK(layer.psnr_db == near(20 * std::log10(4 / std::sqrt(1.25 / 6))));
  CHECK(layer.max_abs == 1.0);
  CHECK_FALSE(layer.identical);
  CHECK_FALSE(result.identical);
  REQUIRE(result.first);
  CHECK(result.first->x == 0);
  CHECK(result.first->y == 0);
  CHECK(result.first->channel == "R");
  CHECK(result.first->a == 0.5F);
  CHECK(result.first->b == 0.0F);
}

TEST_CASE("compare: B is the reference, so relMSE is not symmetric") {
  const Image one = image_of(1, 1, {{"", {"Y"}, {1}}});
  const Image two = image_of(1, 1, {{"", {"Y"}, {2}}});
  CHECK(compare_images(one, two, "a", "b").layers[0].rel_mse == near(1 / 4.01));
  CHECK(compare_images(two, one, "a", "b").layers[0].rel_mse == near(1 / 1.01));
}

TEST_CASE("compare: identical images, and zeros of two signs") {
  const Image b = image_of(1, 1, {{"", {"R", "G", "B"}, {0.0F, 1, 2}}});
  const ImageComparison same = compare_images(b, b, "a", "b");
  CHECK(same.identical);
  CHECK_FALSE(same.first);
  CHECK(same.layers[0].rmse == 0);
  CHECK(std::isinf(same.layers[0].psnr_db));
  CHECK(same.layers[0].psnr_db > 0);

  const Image a = image_of(1, 1, {{"", {"R", "G", "B"}, {-0.0F, 1, 2}}});
  const ImageComparison signs = compare_images(a, b, "a", "b");
  CHECK_FALSE(signs.identical);
  CHECK(signs.layers[0].max_abs == 0);
  CHECK(signs.layers[0].psnr_db == std::numeric_limits<double>::infinity());
}

TEST_CASE("compare: a black reference has a PSNR of minus infinity, not NaN") {
  const Image a = image_of(1, 1, {{"", {"Y"}, {1}}});
  const Image b = image_of(1, 1, {{"", {"Y"}, {0}}});
  CHECK(compare_images(a, b, "a", "b").layers[0].psnr_db == -std::numeric_limits<double>::infinity());
}

TEST_CASE("compare: the first difference is the first in rows, then columns, over all layers") {
  const Image b = image_of(3, 2, {{"", {"Y"}, {0, 0, 0, 0, 0, 0}}, {"depth", {"Z"}, {0, 0, 0, 0, 0, 0}}});
  Image a = b;
  a.layers[0].data[5] = 9;
  a.layers[1].data[2] = 7;
  const ImageComparison result = compare_images(a, b, "a", "b");
  REQUIRE(result.first);
  CHECK(result.first->layer == "depth");
  CHECK(result.first->x == 2);
  CHECK(result.first->y == 0);
  CHECK(result.first->a == 7);
  CHECK(result.layers[0].first->x == 2);
  CHECK(result.layers[0].first->y == 1);
}

TEST_CASE("compare: alpha counts for identity and maximum, not for the means") {
  const Image b = image_of(1, 1, {{"", {"R", "G", "B", "A"}, {1, 1, 1, 1}}});
  const Image a = image_of(1, 1, {{"", {"R", "G", "B", "A"}, {2, 1, 1, 0.25F}}});
  const auto layer = compare_images(a, b, "a", "b").layers[0];
  CHECK(layer.rmse == near(std::sqrt(1.0 / 3)));
  CHECK(layer.max_abs == 1.0);
  const Image c = image_of(1, 1, {{"", {"R", "G", "B", "A"}, {1, 1, 1, 0.25F}}});
  CHECK(compare_images(c, b, "c", "b").layers[0].max_abs == 0.75);
  CHECK_FALSE(compare_images(c, b, "c", "b").identical);
}

TEST_CASE("compare: layers and channels are matched by name, the beauty layer is the headline") {
  const Image b = image_of(1, 1, {{"albedo", {"R", "G", "B"}, {1, 2, 3}}, {"", {"R", "G", "B"}, {4, 5, 6}}});
  const Image a = image_of(1, 1, {{"", {"B", "G", "R"}, {6, 5, 4}}, {"albedo", {"R", "G", "B"}, {1, 2, 3}}});
  const ImageComparison result = compare_images(a, b, "a", "b");
  CHECK(result.identical);
  CHECK(result.layers[result.headline].layer.empty());
  CHECK(compare_images(a, b, "a", "b", "albedo").headline == 0);
  CHECK_THROWS_WITH(compare_images(a, b, "a", "b", "depth"), Catch::Contains("has no layer \"depth\""));
}

TEST_CASE("compare: sums do not lose small terms") {
  // 2^24 + 1 in float would lose every later 1; here 2^21 pixels of error 1 after one of 4096.
  const std::size_t count = std::size_t{1} << 21U;
  Image b = image_of(1 << 21, 1, {{"", {"Y"}, std::vector<float>(count, 0.0F)}});
  Image a = b;
  for (float& value : a.layers[0].data) value = 1;
  a.layers[0].data[0] = 4096;
  const double squares = 4096.0 * 4096.0 + static_cast<double>(count - 1);
  CHECK(compare_images(a, b, "a", "b").layers[0].rmse == near(std::sqrt(squares / static_cast<double>(count))));
}

TEST_CASE("compare: images that do not match or hold NaN or infinity are errors that name the place") {
  const Image b = image_of(2, 1, {{"", {"R", "G", "B"}, {0, 0, 0, 0, 0, 0}}});
  CHECK_THROWS_WITH(compare_images(image_of(1, 2, b.layers), b, "a", "b"),
                    Catch::Contains("1 x 2") && Catch::Contains("2 x 1"));
  Image a = b;
  SECTION("a layer more in A") {
    a.layers.push_back({"depth", {"Z"}, {1, 2}});
    CHECK_THROWS_WITH(compare_images(a, b, "a", "b"), Catch::StartsWith("b: lacks layer \"depth\""));
    CHECK_THROWS_WITH(compare_images(b, a, "b", "a"), Catch::StartsWith("b: lacks layer \"depth\""));
  }
  SECTION("other channels") {
    a.layers[0].channels = {"X", "Y", "Z"};
    CHECK_THROWS_AS(compare_images(a, b, "a", "b"), InputError);
    a.layers[0] = {"", {"R", "G", "B", "A"}, std::vector<float>(8)};
    CHECK_THROWS_AS(compare_images(a, b, "a", "b"), InputError);
    CHECK_THROWS_AS(compare_images(b, a, "b", "a"), InputError);
  }
  SECTION("NaN and infinity") {
    a.layers[0].data[4] = std::numeric_limits<float>::quiet_NaN();
    CHECK_THROWS_WITH(compare_images(a, b, "a", "b"), Catch::StartsWith("a: NaN at pixel (1, 0), channel G"));
    a.layers[0].data[4] = -std::numeric_limits<float>::infinity();
    CHECK_THROWS_WITH(compare_images(b, a, "b", "a"), Catch::StartsWith("a: infinity at pixel (1, 0), channel G"));
  }
  SECTION("several layers and none is the beauty layer") {
    a.layers = {{"x", {"Y"}, {0, 0}}, {"y", {"Y"}, {0, 0}}};
    CHECK_THROWS_WITH(compare_images(a, a, "a", "a"), Catch::Contains("choose one of its layers: x, y"));
    a.layers.pop_back();
    CHECK(compare_images(a, a, "a", "a").headline == 0);
  }
}

TEST_CASE("difference image: absolute differences in every layer, in B's channel order") {
  const Image b = image_of(1, 1, {{"", {"R", "G"}, {1, 5}}, {"depth", {"Z"}, {2}}});
  const Image a = image_of(1, 1, {{"depth", {"Z"}, {0.5F}}, {"", {"G", "R"}, {4, 3}}});
  const Image difference = hemiray::difference_image(a, b, "a", "b");
  REQUIRE(difference.layers.size() == 2);
  CHECK(difference.layers[0].channels == std::vector<std::string>{"R", "G"});
  CHECK(difference.layers[0].data == std::vector<float>{2, 1});
  CHECK(difference.layers[1].data == std::vector<float>{1.5F});
}
