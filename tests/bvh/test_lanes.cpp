// Sets of lanes: the processor's own form and the portable one say the same, alone and in traversal.
#include <catch2/catch.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bvh/query_bench.hpp"

namespace hemiray {
namespace {

// For each mask of 8, 4 and 2 lanes: the lanes in the order they are taken out, as decimal digits (lane + 1), and
// whether the bits of single lanes add up to the set.
constexpr const char* kProbe = R"(#include "lib/lanes.h"
#include "lib/accel_layout.h"
static uint lanes_in_order(LaneSet s) {
  uint digits = 0;
  for (; s; s = without_first(s)) digits = 10 * digits + first_lane(s) + 1;
  return digits;
}
static uint is_sum_of_bits(LaneSet s, int8 m, uint lanes) {
  const int a[8] = {m.s0, m.s1, m.s2, m.s3, m.s4, m.s5, m.s6, m.s7};
  LaneSet sum = 0;
  for (uint i = 0; i < lanes; i++) {
    if (a[i]) sum |= lane_bit(i);
  }
  return lanes_in_order(sum) == lanes_in_order(s) && (sum != 0) == (s != 0);
}
kernel void probe_form(global uint* out) { out[0] = HR_LANE_MASK; }
kernel void probe_lanes(global uint* out) {
  const uint i = (uint)get_global_id(0);
  const uint8 bits = (uint8)(1, 2, 4, 8, 16, 32, 64, 128);
  // By comparison, as traversal makes them.
  const float8 v = convert_float8(bits & (uint8)(i));
  const int8 m = v > (float8)(0.5f);
  const LaneSet s8 = lanes_of8(m), s4 = lanes_of4(m.lo), s2 = lanes_of2(m.s01);
  out[7 * i] = lanes_in_order(s8);
  out[7 * i + 1] = lanes_in_order(s4);
  out[7 * i + 2] = lanes_in_order(s2);
  out[7 * i + 3] = is_sum_of_bits(s8, m, 8);
  out[7 * i + 4] = is_sum_of_bits(s4, m, 4);
  out[7 * i + 5] = is_sum_of_bits(s2, m, 2);
  int16 wide = (int16)(0);
  wide.lo = i & 1 ? m : (int8)(0);
  wide.hi = i & 1 ? (int8)(0) : m;
  out[7 * i + 6] = any_lane16(wide) ? 1 : 0;
}
)";

std::uint32_t digits_of(std::uint32_t mask, unsigned lanes) {
  std::uint32_t digits = 0;
  for (unsigned lane = 0; lane < lanes; lane++) {
    if ((mask >> lane & 1U) != 0) digits = 10 * digits + lane + 1;
  }
  return digits;
}

std::vector<std::uint32_t> run_probe(Context& context, const char* kernel, const std::string& defines,
                                     std::uint32_t items) {
  const test::KernelFolder folder("probe/lanes.cl", kProbe);
  Program program(context, "lanes", {"probe/lanes.cl"}, ProgramOptions{0, false, defines});
  const Buffer<std::uint32_t> out(context, "out", std::size_t{7} * items);
  launch(context, program.kernel(kernel), items, arguments(arg("out", out)));
  return out.read();
}

// The forms that this device has: 2 is portable.
std::vector<int> forms_of(Context& context) {
  const std::uint32_t chosen = run_probe(context, "probe_form", "", 1)[0];
  REQUIRE((chosen == 1 || chosen == 2));
  if (chosen == 2) WARN("the device has no lane mask of its own: only the portable form is tested");
  return chosen == 1 ? std::vector<int>{1, 2} : std::vector<int>{2};
}

}  // namespace

TEST_CASE("both forms of lane masks hold the lanes that were compared true, first to last") {
  Context context(choose_device(""));
  for (const int form : forms_of(context)) {
    const std::vector<std::uint32_t> out =
        run_probe(context, "probe_lanes", "-DHR_LANE_MASK=" + std::to_string(form), 256);
    for (std::uint32_t mask = 0; mask < 256; mask++) {
      INFO("form " << form << ", mask " << mask);
      CHECK(out[7 * mask] == digits_of(mask, 8));
      CHECK(out[7 * mask + 1] == digits_of(mask, 4));
      CHECK(out[7 * mask + 2] == digits_of(mask, 2));
      CHECK(out[7 * mask + 3] == 1);
      CHECK(out[7 * mask + 4] == 1);
      CHECK(out[7 * mask + 5] == 1);
      CHECK(out[7 * mask + 6] == (mask != 0 ? 1U : 0U));
    }
  }
}

TEST_CASE("rays find the same with both forms of lane masks") {
  test::TreeWorkshop workshop;
  const FlatScene flat = test::soup(2000, 200, 0.1F, 40);
  const test::Rays rays = test::random_rays(20000, 41);
  if (forms_of(workshop.context).size() < 2) return;  // nothing to compare
  for (const std::size_t k : {0U, 2U, 5U, 6U}) {      // vectors of 8, loops, vectors of 2 and of 4
    const test::TreeKind& kind = test::tree_kinds()[k];
    INFO(kind.name);
    test::QueryBench bench(workshop, flat, kind.options);
    const test::Hits own = bench.queries.intersect(rays);
    CHECK(test::count_found(own) > rays.size() / 4);
    CHECK(test::count_different(rays, bench.intersect_with(rays, "-DHR_LANE_MASK=2"), own) == 0);
  }
}

}  // namespace hemiray
