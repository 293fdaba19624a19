// The device's own arithmetic: random numbers bit for bit, elementary functions of strict builds within stated bounds.
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "host/base/rng.hpp"
#include "host/gpu/program.hpp"
#include "shared/scalar.h"
#include "tests/reference/reference_random.hpp"
#include "tests/support/kernel_folder.hpp"

namespace hemiray {
namespace {

// Bounds of the errors over the tested arguments. The series add a few roundings to their dropped terms (lib/math.h):
// half an ulp for each operation on a term near the result's size.
constexpr double kLog2Ulps = 5.0;    // relative, in units of 2^-24 of the result
constexpr double kExp2Ulps = 3.0;    // likewise
constexpr double kSincosUlps = 2.0;  // absolute, in units of 2^-24
constexpr double kUlp = 0x1p-24;

template <typename In, typename Out>
std::vector<Out> run_probe(const std::string& kernel_text, const std::vector<In>& in, bool strict) {
  const test::KernelFolder folder("probe/math.cl", kernel_text);
  Context context(choose_device(""));
  Program program(context, "math probe", {"probe/math.cl"}, {0, strict});
  const Buffer<In> device_in(context, "in", std::span<const In>(in));
  const Buffer<Out> device_out(context, "out", in.size());
  launch(context, program.kernel("probe"), in.size(), arguments(arg("in", device_in), arg("out", device_out)));
  return device_out.read();
}

std::string probe_of(const std::string& header, const std::string& in, const std::string& out,
                     const std::string& expression) {
  return "#include \"lib/" + header + ".h\"\nkernel void probe(global const " + in + "* in, global " + out +
         "* out) {\n  const size_t i = get_global_id(0);\n  const " + in + " x = in[i];\n  out[i] = " + expression +
         ";\n}\n";
}

std::vector<shared::uint4> random_words(std::size_t count) {
  std::mt19937 random(3);
  const auto next = [&random] { return static_cast<std::uint32_t>(random()); };
  std::vector<shared::uint4> words = {{0, 0, 0, 0}, {~0U, ~0U, ~0U, ~0U}, {1, 0, 0, 0}, {0, 0, 0, 1}};
  while (words.size() < count) words.push_back({next(), next(), next(), next()});
  return words;
}

// Floats in (0, 1]: all magnitudes, around powers of two, and close to 1, where the logarithm vanishes.
std::vector<float> unit_arguments() {
  std::vector<float> values = {1.0F, std::nextafter(1.0F, 0.0F), 0.5F, 0.70710677F, 0.70710683F, 1.1754944e-38F};
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  for (int i = 0; i < 200000; i++) {
    values.push_back(std::max(uniform(random), 1e-30F));
    values.push_back(std::exp2(-125.0F * uniform(random)));
    values.push_back(1.0F - 0.01F * uniform(random) * uniform(random));
  }
  return values;
}

}  // namespace

TEST_CASE("random words on the device are those of the host, bit for bit") {
  const std::vector<shared::uint4> words = random_words(20000);
  const auto out =
      run_probe<shared::uint4, shared::uint4>(probe_of("rng", "uint4", "uint4", "rng_hash(x)"), words, false);
  for (std::size_t i = 0; i < words.size(); i++) {
    const RngWords key = {words[i].x, words[i].y, words[i].z, words[i].w};
    const RngWords expected = rng_hash(key);
    REQUIRE(RngWords{out[i].x, out[i].y, out[i].z, out[i].w} == expected);
    REQUIRE(reference::pcg4d(key) == expected);
  }
}

TEST_CASE("pixel offsets and unit numbers on the device are those of the host, bit for bit") {
  std::vector<shared::uint4> keys = random_words(20000);
  for (std::size_t i = 0; i < keys.size(); i++) keys[i].z = static_cast<std::uint32_t>(i % 5);
  const auto out = run_probe<shared::uint4, shared::float4>(
      probe_of("rng", "uint4", "float4",
               "(float4)(rng_pixel_offset(x.x, x.y, x.z, x.w), rng_unit(x.x), rng_unit(rng_sobol1(x.y)))"),
      keys, false);
  for (std::size_t i = 0; i < keys.size(); i++) {
    const Vec2 offset = rng_pixel_offset(keys[i].x, keys[i].y, keys[i].z, keys[i].w);
    REQUIRE(out[i].x == offset.x);
    REQUIRE(out[i].y == offset.y);
    REQUIRE(out[i].z == rng_unit(keys[i].x));
    REQUIRE(out[i].w == rng_unit(rng_sobol1(keys[i].y)));
    REQUIRE(std::max({out[i].x, out[i].y, out[i].z, out[i].w}) < 1.0F);
    if (keys[i].z == 1) REQUIRE((offset.x == 0.5F && offset.y == 0.5F));
  }
}

TEST_CASE("strict log2 is within its bound from 0 to 1") {
  const std::vector<float> x = unit_arguments();
  for (const bool strict : {true, false}) {
    const auto out = run_probe<float, float>(probe_of("math", "float", "float", "strict_log2(x)"), x, strict);
    double worst = 0.0;
    for (std::size_t i = 0; i < x.size(); i++) {
      const double exact = std::log2(static_cast<double>(x[i]));
      if (exact == 0.0) {
        REQUIRE(out[i] == 0.0F);
      } else {
        worst = std::max(worst, std::abs(out[i] - exact) / (std::abs(exact) * kUlp));
      }
    }
    INFO("worst error " << worst << " ulps");
    CHECK(worst <= kLog2Ulps);
  }
}

TEST_CASE("strict exp2 is within its bound, zero below the normal range, and never infinite") {
  std::vector<float> x = {0.0F, -0.0F, -0.5F, 0.5F, -1.0F, -126.0F, std::nextafter(-126.0F, -127.0F), -1e30F};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-126.0F, 20.0F);
  for (int i = 0; i < 300000; i++) x.push_back(uniform(random) * (i % 3 == 0 ? 0.01F : 1.0F));
  const auto out = run_probe<float, float>(probe_of("math", "float", "float", "strict_exp2(x)"), x, true);
  double worst = 0.0;
  for (std::size_t i = 0; i < x.size(); i++) {
    if (x[i] < -126.0F) {
      REQUIRE(out[i] == 0.0F);
      continue;
    }
    const double exact = std::exp2(static_cast<double>(x[i]));
    worst = std::max(worst, std::abs(out[i] - exact) / (exact * kUlp));
  }
  INFO("worst error " << worst << " ulps");
  CHECK(worst <= kExp2Ulps);
}

TEST_CASE("the strict cosine lobe is within the bound its parts imply") {
  std::vector<shared::float2> x = {{0, 0},    {0, 5},     {1, 0},      {1, 1e6F},
                                   {0.5F, 1}, {0.5F, -1}, {1e-39F, 2}, {1e-30F, 100}};
  std::mt19937 random(6);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  for (int i = 0; i < 300000; i++) {
    const float cosine = i % 2 == 0 ? uniform(random) : 1.0F - 0.02F * uniform(random);
    x.push_back({cosine, std::exp2(20.0F * uniform(random))});
  }
  const auto out =
      run_probe<shared::float2, float>(probe_of("math", "float2", "float", "cosine_power(x.x, x.y)"), x, true);
  CHECK(out[0] == 1.0F);  // 0^0
  CHECK(out[1] == 0.0F);
  CHECK(out[2] == 1.0F);
  CHECK(out[3] == 1.0F);
  CHECK(out[4] == 0.5F);
  CHECK(out[5] == 1.0F);
  CHECK(out[6] == 0.0F);
  CHECK(out[7] == 0.0F);
  for (std::size_t i = 8; i < x.size(); i++) {
    const double exponent = static_cast<double>(x[i].y) * std::log2(static_cast<double>(x[i].x));
    const double exact = std::exp2(exponent);
    // The logarithm's relative error and that of the product become an absolute error of the exponent.
    const double bound = (kExp2Ulps + (kLog2Ulps + 1.0) * std::numbers::ln2 * std::abs(exponent)) * kUlp * exact;
    INFO(x[i].x << " ^ " << x[i].y);
    REQUIRE(out[i] == Approx(exact).epsilon(0).margin(bound + 0x1p-125));  // the least normal numbers become zero
    REQUIRE(out[i] <= 1.0F);
  }
}

TEST_CASE("strict sine and cosine of a turn are within their bound and exact at quarters") {
  std::vector<float> u = {0.0F, 0.125F, 0.25F, 0.375F, 0.5F, 0.625F, 0.75F, 0.875F, 1.0F, std::nextafter(1.0F, 0.0F)};
  std::mt19937 random(7);
  for (int i = 0; i < 300000; i++) u.push_back(rng_unit(static_cast<std::uint32_t>(random())));
  const auto out = run_probe<float, shared::float2>(probe_of("math", "float", "float2", "sincos_turn(x)"), u, true);
  double worst = 0.0;
  for (std::size_t i = 0; i < u.size(); i++) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(u[i]);
    worst = std::max({worst, std::abs(out[i].x - std::sin(angle)) / kUlp, std::abs(out[i].y - std::cos(angle)) / kUlp});
  }
  INFO("worst error " << worst << " units of 2^-24");
  CHECK(worst <= kSincosUlps);
  for (std::size_t i = 0; i <= 8; i += 2) {
    const double angle = std::numbers::pi * static_cast<double>(i) / 4.0;
    CHECK(out[i].x == std::round(std::sin(angle)));
    CHECK(out[i].y == std::round(std::cos(angle)));
  }
}

// Strict builds: what the device promises to round, and both replacements where it does not, by force.
TEST_CASE("strict quotients and square roots are rounded correctly on every device") {
  std::mt19937 random(8);
  const auto word = [&random] { return static_cast<std::uint32_t>(random()); };
  const auto number = [&word](bool any_exponent) {
    const std::uint32_t mantissa = word() % 8 == 0 ? 0x7fffffU - word() % 3 : word() >> 9U;
    return std::bit_cast<float>(word() << 31U | (any_exponent ? 70U + word() % 116U : 127U) << 23U | mantissa);
  };
  std::vector<shared::float2> in = {{1, 3},      {0, 5}, {-0.0F, 5},    {1, 0},       {0, 0},
                                    {-7, 1e-3F}, {2, 1}, {INFINITY, 2}, {3, INFINITY}};
  while (in.size() < 1000000) in.push_back({number(in.size() % 2 == 0), number(in.size() % 2 == 0)});
  for (const std::string forced :
       {"", "#undef HR_ROUNDS_DIVIDE\n", "#undef HR_ROUNDS_DIVIDE\n#define HR_WITHOUT_DOUBLE 1\n"}) {
    const std::string text =
        probe_of("divide", "float2", "float2", "(float2)(divide(x.x, x.y), square_root(fabs(x.x)))");
    const auto out = run_probe<shared::float2, shared::float2>(forced + text, in, true);
    INFO(forced);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < in.size(); i++) {
      const float quotient = in[i].x / in[i].y, root = std::sqrt(std::abs(in[i].x));
      const auto differs = [](float a, float b) {
        return std::bit_cast<std::uint32_t>(a) != std::bit_cast<std::uint32_t>(b) && !(std::isnan(a) && std::isnan(b));
      };
      if (differs(out[i].x, quotient) || differs(out[i].y, root)) {
        if (wrong++ == 0) {
          UNSCOPED_INFO("first: " << in[i].x << " / " << in[i].y << " gives " << out[i].x << ", the root " << out[i].y);
        }
      }
    }
    CHECK(wrong == 0);
  }
}

}  // namespace hemiray
