#include "host/stability/ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "host/bvh/leaving_rays.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/scene/features.hpp"
#include "host/stability/bounds.hpp"
#include "host/stability/leaving.hpp"
#include "shared/features.h"

namespace hemiray::stability {
namespace {

std::uint32_t features_for(const FlatScene& flat) {
  return triangle_features(flat) | (flat.spheres.empty() ? 0U : HR_FEATURE_SPHERES) |
         (flat.shapes.empty() ? 0U : HR_FEATURE_SHAPES) | (flat.tapes.empty() ? 0U : HR_FEATURE_IMPLICITS) |
         (flat.instances.empty() ? 0U : HR_FEATURE_INSTANCES);
}

// Packets and the peer trace these alone.
bool only_triangles(const FlatScene& flat) { return flat.spheres.empty() && flat.shapes.empty(); }

// But for the sign of a zero.
bool same_bits(const shared::QueryHit& a, const shared::QueryHit& b) {
  return a.primitive == b.primitive && a.t == b.t && a.u == b.u && a.v == b.v;
}

struct DeviceTree {
  DeviceTree(Context& context, AccelBuilder& builder, const FlatScene& flat)
      : scene(context, flat, features_for(flat)), accel(builder, scene) {}
  DeviceScene scene;
  Accel accel;
};

// How many of the rays, asked again one by one, the device says it cannot tell of.
std::uint64_t count_owned_up(const DeviceTree& tree, RayQueries& queries, const Rays& rays,
                             const std::vector<std::uint32_t>& missed) {
  std::uint64_t count = 0;
  for (const std::uint32_t i : missed) {
    const std::uint64_t before = tree.scene.uncertain_roots();
    static_cast<void>(queries.intersect({&rays.rays[i], 1}));
    count += tree.scene.uncertain_roots() > before ? 1 : 0;
  }
  return count;
}

}  // namespace

Ladder::Ladder(Context& context, LadderOptions options)
    : context_(&context), options_(std::move(options)), parallel_(context), builder_(context, parallel_) {
  options_.rays = std::max(1U, (options_.rays + kRaysFromOnePoint - 1) / kRaysFromOnePoint) * kRaysFromOnePoint;
}

void Ladder::run_hits(const Rung& rung, RungResult& result, AnswerHash& hash) {
  const Rays rays = rung.rays(options_.rays, options_.seed);
  const DeviceTree tree(*context_, builder_, rung.flat);
  RayQueries single(*context_, tree.scene, tree.accel, options_.strict, RayGrouping::single, options_.double_precision);
  std::vector<Answers> answers(1);
  answers[0].hits = single.intersect(rays.rays);
  const bool implicit = !rung.flat.tapes.empty();
  if (implicit) result.open_regions = tree.scene.uncertain_roots();
  answers[0].occluded = single.occluded(rays.rays);
  const bool has_packets = tree.accel.config().has_packets() && only_triangles(rung.flat) && !options_.double_precision;
  if (has_packets) {
    RayQueries packets(*context_, tree.scene, tree.accel, options_.strict, RayGrouping::packets);
    answers.push_back({packets.intersect(rays.rays), packets.occluded(rays.rays)});
    for (std::size_t i = 0; i < rays.rays.size(); i++) {
      result.other_bits += same_bits(answers[0].hits[i], answers[1].hits[i]) ? 0 : 1;
    }
  }
  if (options_.tamper) options_.tamper(answers[0].hits);
  for (const Answers& one : answers) {
    hash.add(std::span<const shared::QueryHit>(one.hits));
    hash.add(std::span<const std::uint32_t>(one.occluded));
  }
  const bool has_peer = options_.peer != nullptr && only_triangles(rung.flat);
  if (has_peer) {
    options_.peer->build(rung.flat);
    options_.peer->load_rays(rays.rays);
    options_.peer->intersect();
    answers.push_back({options_.peer->hits(), {}});
  }
  const Judged judged = judge_all(rung.flat, rays, answers, options_.threads);
  result.ours = judged.tallies[0];
  if (implicit) {
    result.ours.uncertain = count_owned_up(tree, single, rays, judged.missed);
    result.ours.missed -= result.ours.uncertain;
  }
  if (has_packets) result.packets = judged.tallies[1];
  if (has_peer) result.peer = judged.tallies.back();
}

void Ladder::run_leaving(const Rung& rung, RungResult& result, AnswerHash& hash) {
  const Rays rays = rung.rays(options_.rays, options_.seed);
  const std::vector<shared::float4> wanted = wanted_ways(rung, rays, options_.seed + 1);
  const DeviceTree tree(*context_, builder_, rung.flat);
  const LeavingRays answers = leave_surfaces(*context_, tree.scene, tree.accel, rays.rays, wanted, options_.strict);
  hash.add(std::span<const shared::QueryHit>(answers.hits));
  hash.add(std::span<const shared::QueryRay>(answers.leaving));
  hash.add(std::span<const shared::QueryHit>(answers.next));
  result.ours = judge_leaving(rung, rays, wanted, answers);
}

std::optional<RungResult> Ladder::run(const std::string& case_name, const Rung& rung) {
  if (options_.double_precision && rung.kind == RungKind::leaving) return std::nullopt;
  RungResult result;
  result.case_name = case_name;
  result.rung = rung.name;
  result.kind = rung.kind;
  AnswerHash hash;
  switch (rung.kind) {
    case RungKind::hits:
      run_hits(rung, result, hash);
      break;
    case RungKind::leaving:
      run_leaving(rung, result, hash);
      break;
    case RungKind::picture:
      // A pixel is several rays.
      result.ours = rung.picture(
          {*context_, std::max(options_.rays / 16, 1024U), options_.double_precision, options_.strict, hash});
      break;
  }
  result.answers = hash.text();
  check_bounds(result);
  return result;
}

void Ladder::check_bounds(RungResult& result) {
  result.broken = broken_bounds(result.case_name, result.rung, result.ours);
  const auto hold = [&result](std::string_view rate, std::uint64_t count) {
    const double most = most_allowed(result.case_name, result.rung, rate) * static_cast<double>(result.ours.rays);
    if (static_cast<double>(count) > most) {
      result.broken.push_back(fmt::format("{} {} of {}", rate, count, result.ours.rays));
    }
  };
  if (result.open_regions) hold(kOpenRegions, *result.open_regions);
  if (!result.packets) return;
  for (const std::string& broken : broken_bounds(result.case_name, result.rung, *result.packets)) {
    result.broken.push_back("in packets " + broken);
  }
  hold(kOtherBits, result.other_bits);
}

}  // namespace hemiray::stability
