// Shared structs lie in memory alike on host and device: size, and offset and size of every member, told by a kernel
// that is made from the same list as the host's.
#include <catch2/catch.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "host/gpu/program.hpp"
#include "host/path/branch_stack.hpp"
#include "shared/bvh_types.h"
#include "shared/features.h"
#include "shared/params.h"
#include "shared/radiosity_types.h"
#include "shared/scene_types.h"
#include "tests/support/kernel_folder.hpp"

namespace hemiray {
namespace {

// Half of what these say is that nobody changes a size without meaning to.
static_assert(sizeof(shared::float2) == 8 && alignof(shared::float2) == 8);
static_assert(sizeof(shared::float4) == 16 && alignof(shared::float4) == 16);
static_assert(sizeof(shared::uint2) == 8 && alignof(shared::uint2) == 8);
static_assert(sizeof(shared::uint4) == 16 && alignof(shared::uint4) == 16);
static_assert(sizeof(shared::Material) == 128 && alignof(shared::Material) == 16);
static_assert(sizeof(shared::Texture) == 32);
static_assert(sizeof(shared::Instance) == 128 && alignof(shared::Instance) == 16);
static_assert(sizeof(shared::Sphere) == 32 && alignof(shared::Sphere) == 16);
static_assert(sizeof(shared::Shape) == 160 && alignof(shared::Shape) == 16);
static_assert(sizeof(shared::Plane) == 48 && alignof(shared::Plane) == 16);
static_assert(sizeof(shared::Light) == 112 && alignof(shared::Light) == 16);
static_assert(sizeof(shared::Emitter) == 16);
static_assert(sizeof(shared::Box) == 32 && alignof(shared::Box) == 16);
static_assert(sizeof(shared::BinaryNode) == 64 && alignof(shared::BinaryNode) == 16);
static_assert(sizeof(shared::TopNode) == 64 && alignof(shared::TopNode) == 16);
static_assert(sizeof(shared::CollapseRegion) == 48);
static_assert(sizeof(shared::BoundsPartial) == 80 && alignof(shared::BoundsPartial) == 16);
static_assert(sizeof(shared::QueryRay) == 32 && alignof(shared::QueryRay) == 16);
static_assert(sizeof(shared::QueryHit) == 16);
static_assert(sizeof(shared::HemicubeParams) == 32);
static_assert(sizeof(shared::RenderParams) == 160 && alignof(shared::RenderParams) == 16);

struct Member {
  std::string name;
  std::size_t offset;
  std::size_t size;
};

struct Layout {
  std::string name;
  std::size_t size;
  std::vector<Member> members;
};

#define HR_MEMBER(type, member) \
  { #member, offsetof(shared::type, member), sizeof(shared::type::member) }
#define HR_FOUR(type, a, b, c, d) HR_MEMBER(type, a), HR_MEMBER(type, b), HR_MEMBER(type, c), HR_MEMBER(type, d)

const std::vector<Layout>& layouts() {
  static const std::vector<Layout> kLayouts = {
      {"Material",
       sizeof(shared::Material),
       {HR_FOUR(Material, kd, ks, ka, kr), HR_FOUR(Material, kt, emission, kd_texture, metallic_roughness_texture),
        HR_FOUR(Material, emission_texture, normal_texture, flags, translucency_r), HR_MEMBER(Material, translucency_g),
        HR_MEMBER(Material, translucency_b)}},
      {"Texture",
       sizeof(shared::Texture),
       {HR_FOUR(Texture, first_texel, width, height, flags), HR_FOUR(Texture, wrap_u, wrap_v, pad0, pad1)}},
      {"Sphere",
       sizeof(shared::Sphere),
       {HR_FOUR(Sphere, center_radius, material, object, pad0), HR_MEMBER(Sphere, pad1)}},
      {"Instance",
       sizeof(shared::Instance),
       {HR_FOUR(Instance, to_world_x, to_world_y, to_world_z, to_object_x),
        HR_FOUR(Instance, to_object_y, to_object_z, first_id, first_triangle),
        HR_FOUR(Instance, triangle_count, mesh, object, material), HR_MEMBER(Instance, flags),
        HR_MEMBER(Instance, pad)}},
      {"Shape",
       sizeof(shared::Shape),
       {HR_FOUR(Shape, to_own_x, to_own_y, to_own_z, form), HR_FOUR(Shape, mixed, linear, clip, lo),
        HR_FOUR(Shape, hi, kind, flags, material), HR_MEMBER(Shape, object)}},
      {"Plane",
       sizeof(shared::Plane),
       {HR_FOUR(Plane, point, normal, material, object), HR_MEMBER(Plane, pad0), HR_MEMBER(Plane, pad1)}},
      {"Light",
       sizeof(shared::Light),
       {HR_FOUR(Light, position, direction, intensity, edge_u), HR_FOUR(Light, edge_v, kind, samples_u, samples_v),
        HR_FOUR(Light, sample_count, first_sample, jitter, first_primitive), HR_MEMBER(Light, primitive_count)}},
      {"Emitter", sizeof(shared::Emitter), {HR_FOUR(Emitter, primitive, cumulative, inverse_pdf, pad)}},
      {"Box", sizeof(shared::Box), {HR_MEMBER(Box, lo), HR_MEMBER(Box, hi)}},
      {"BinaryNode", sizeof(shared::BinaryNode), {HR_FOUR(BinaryNode, x, y, z, child)}},
      {"TopNode",
       sizeof(shared::TopNode),
       {HR_FOUR(TopNode, lo, hi, left, right), HR_FOUR(TopNode, parent, reference, primitives, target),
        HR_MEMBER(TopNode, pad0), HR_MEMBER(TopNode, pad1)}},
      {"CollapseRegion",
       sizeof(shared::CollapseRegion),
       {HR_FOUR(CollapseRegion, root, primitives, stack_load, parent_slot),
        HR_FOUR(CollapseRegion, nodes, blocks, stack, final_node),
        HR_FOUR(CollapseRegion, final_block, pad0, pad1, pad2)}},
      {"BoundsPartial",
       sizeof(shared::BoundsPartial),
       {HR_FOUR(BoundsPartial, lo, hi, centroid_lo, centroid_hi),
        HR_FOUR(BoundsPartial, valid, non_finite, degenerate, pad)}},
      {"QueryRay", sizeof(shared::QueryRay), {HR_MEMBER(QueryRay, origin), HR_MEMBER(QueryRay, direction)}},
      {"QueryHit", sizeof(shared::QueryHit), {HR_FOUR(QueryHit, t, u, v, primitive)}},
      {"HemicubeParams",
       sizeof(shared::HemicubeParams),
       {HR_FOUR(HemicubeParams, resolution, divisions, turned, jittered),
        HR_FOUR(HemicubeParams, seed_key, row_count, side_count, pad)}},
      {"RenderParams",
       sizeof(shared::RenderParams),
       {HR_FOUR(RenderParams, camera_position, camera_right, camera_up, camera_back),
        HR_FOUR(RenderParams, background, ambient, width, height),
        HR_FOUR(RenderParams, first_pixel, slot_count, sample, samples),
        HR_FOUR(RenderParams, seed_key, max_depth, triangle_count, sphere_count),
        HR_FOUR(RenderParams, plane_count, light_count, emitter_count, instance_count),
        HR_MEMBER(RenderParams, shape_count), HR_MEMBER(RenderParams, gather_rays)}},
  };
  return kLayouts;
}

#undef HR_FOUR
#undef HR_MEMBER

// A kernel that writes the struct's size, its alignment, then offset and size of each member.
std::string probe_kernel(const Layout& layout) {
  std::string text = "kernel void layout_" + layout.name + "(global uint* out) {\n  " + layout.name + " s;\n" +
                     "  struct { char first; " + layout.name + " s; } aligned;\n  uint i = 0;\n" +
                     "  out[i++] = (uint)sizeof(s);\n  out[i++] = (uint)((char*)&aligned.s - (char*)&aligned);\n";
  for (const Member& member : layout.members) {
    text += "  out[i++] = (uint)((char*)&s." + member.name + " - (char*)&s);\n  out[i++] = (uint)sizeof(s." +
            member.name + ");\n";
  }
  return text + "}\n";
}

}  // namespace

TEST_CASE("every shared struct lies in memory alike on host and device") {
  std::string text =
      "#include \"shared/scene_types.h\"\n#include \"shared/bvh_types.h\"\n#include \"shared/params.h\"\n"
      "#include \"shared/radiosity_types.h\"\n";
  for (const Layout& layout : layouts()) text += probe_kernel(layout);
  const test::KernelFolder folder("probe/layout.cl", text);
  Context context(choose_device(""));
  Program program(context, "layout", {"probe/layout.cl"}, {});
  Buffer<std::uint32_t> out(context, "out", 64);
  for (const Layout& layout : layouts()) {
    launch(context, program.kernel("layout_" + layout.name), 1, arguments(arg("out", out)));
    const std::vector<std::uint32_t> values = out.read();
    INFO("struct " << layout.name);
    CHECK(values[0] == layout.size);
    CHECK(layout.size % values[1] == 0);
    for (std::size_t i = 0; i < layout.members.size(); i++) {
      INFO("member " << layout.members[i].name);
      CHECK(values[2 + 2 * i] == layout.members[i].offset);
      CHECK(values[3 + 2 * i] == layout.members[i].size);
    }
  }
}

TEST_CASE("shared structs are padded explicitly, and the lists of members above are complete") {
  for (const Layout& layout : layouts()) {
    std::size_t end = 0;
    for (const Member& member : layout.members) {
      INFO(layout.name << "::" << member.name);
      CHECK(member.offset == end);
      end = member.offset + member.size;
    }
    INFO(layout.name);
    CHECK(end == layout.size);
  }
}

TEST_CASE("no shared struct is missing from the lists above") {
  std::set<std::string> listed;
  for (const Layout& layout : layouts()) listed.insert(layout.name);
  std::set<std::string> declared;
  const std::regex declaration("typedef struct ([A-Za-z]+) \\{");
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(HR_SOURCE_DIR) / "kernels/shared")) {
    const std::string text = test::read_whole_file(entry.path());
    for (std::sregex_iterator found(text.begin(), text.end(), declaration), end; found != end; ++found) {
      declared.insert((*found)[1].str());
    }
  }
  CHECK(listed == declared);
}

TEST_CASE("a pending branch takes as much memory on the device as the host sets aside") {
  const test::KernelFolder folder(
      "probe/branch.cl",
      "#include \"path/path_context.h\"\n"
      "kernel void probe_branch(global uint* out) { out[0] = (uint)sizeof(PendingBranch); }\n");
  Context context(choose_device(""));
  for (const bool double_precision : {false, true}) {
    if (double_precision && !context.device().has_fp64) continue;
    ProgramOptions options{HR_FEATURE_BRANCHING};
    options.double_precision = double_precision;
    Program program(context, "branch", {"probe/branch.cl"}, options);
    Buffer<std::uint32_t> out(context, "out", 1);
    launch(context, program.kernel("probe_branch"), 1, arguments(arg("out", out)));
    const std::uint32_t device_size = out.read().front();
    const std::uint64_t before = context.allocated_bytes();
    const BranchStack stack(context, options, 7, 3);
    CHECK(context.allocated_bytes() - before == std::uint64_t{7} * 3 * device_size);
  }
  const std::uint64_t with = context.allocated_bytes();
  const BranchStack none(context, {}, 7, 3);
  CHECK(context.allocated_bytes() == with);
}

}  // namespace hemiray
