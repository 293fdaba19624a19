#include "host/stability/ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "host/bvh/leaving_rays.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/scene/features.hpp"
#include "host/stability/bounds.hpp"
#include "host/stability/leaving.hpp"
#include "host/stability/oracle.hpp"

namespace hemiray::stability {
namespace {

constexpr std::size_t kChunk = 4096;  // rays that a thread judges at a time, a multiple of kRaysFromOnePoint

std::uint32_t features_for(const FlatScene& flat) {
  return triangle_features(flat) | (flat.spheres.empty() ? 0U : HR_FEATURE_SPHERES);
}

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

}  // namespace

std::vector<Tally> judge_all(const FlatScene& flat, const Rays& rays, std::span<const Answers> answers,
                             unsigned threads) {
  const Oracle oracle(flat);
  std::vector<Tally> sums(answers.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      Oracle::Session session(oracle);
      std::vector<Tally> mine(answers.size());
      for (;;) {
        const std::size_t first = next.fetch_add(kChunk), end = std::min(rays.rays.size(), first + kChunk);
        if (first >= rays.rays.size()) break;
        for (std::size_t i = first; i < end; i++) {
          const Truth truth = session.meet(rays.rays[i]);
          for (std::size_t k = 0; k < answers.size(); k++) {
            const Answers& given = answers[k];
            session.judge(rays.rays[i], truth, given.hits[i], rays.inside[i] != 0 && !truth.empty(), mine[k]);
            const bool found = given.hits[i].primitive != HR_NO_PRIMITIVE;
            mine[k].any_hit += !given.occluded.empty() && (given.occluded[i] != 0) != found ? 1 : 0;
          }
        }
      }
      const std::scoped_lock lock(mutex);
      for (std::size_t k = 0; k < answers.size(); k++) sums[k].add(mine[k]);
    } catch (...) {
      const std::scoped_lock lock(mutex);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; i++) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  return sums;
}

Ladder::Ladder(Context& context, LadderOptions options)
    : context_(&context), options_(std::move(options)), parallel_(context), builder_(context, parallel_) {
  options_.rays = std::max(1U, (options_.rays + kRaysFromOnePoint - 1) / kRaysFromOnePoint) * kRaysFromOnePoint;
}

void Ladder::run_hits(const Rung& rung, RungResult& result) {
  const Rays rays = rung.rays(options_.rays, options_.seed);
  std::vector<Answers> answers(1);
  bool has_packets = false;
  {
    const DeviceTree tree(*context_, builder_, rung.flat);
    RayQueries single(*context_, tree.scene, tree.accel, false, RayGrouping::single, options_.double_precision);
    answers[0] = {single.intersect(rays.rays), single.occluded(rays.rays)};
    has_packets = tree.accel.config().has_packets() && rung.flat.spheres.empty() && !options_.double_precision;
    if (has_packets) {
      RayQueries packets(*context_, tree.scene, tree.accel, false, RayGrouping::packets);
      answers.push_back({packets.intersect(rays.rays), packets.occluded(rays.rays)});
      for (std::size_t i = 0; i < rays.rays.size(); i++) {
        result.other_bits += same_bits(answers[0].hits[i], answers[1].hits[i]) ? 0 : 1;
      }
    }
  }
  if (options_.tamper) options_.tamper(answers[0].hits);
  const bool has_peer = options_.peer != nullptr && rung.flat.spheres.empty();
  if (has_peer) {
    options_.peer->build(rung.flat);
    options_.peer->load_rays(rays.rays);
    options_.peer->intersect();
    answers.push_back({options_.peer->hits(), {}});
  }
  const std::vector<Tally> tallies = judge_all(rung.flat, rays, answers, options_.threads);
  result.ours = tallies[0];
  if (has_packets) result.packets = tallies[1];
  if (has_peer) result.peer = tallies.back();
}

void Ladder::run_leaving(const Rung& rung, RungResult& result) {
  const Rays rays = rung.rays(options_.rays, options_.seed);
  const std::vector<shared::float4> wanted = wanted_ways(rung, rays, options_.seed + 1);
  const DeviceTree tree(*context_, builder_, rung.flat);
  const LeavingRays answers = leave_surfaces(*context_, tree.scene, tree.accel, rays.rays, wanted);
  result.ours = judge_leaving(rung, rays, wanted, answers);
}

std::optional<RungResult> Ladder::run(const std::string& case_name, const Rung& rung) {
  if (options_.double_precision && rung.kind == RungKind::leaving) return std::nullopt;
  RungResult result;
  result.case_name = case_name;
  result.rung = rung.name;
  result.kind = rung.kind;
  switch (rung.kind) {
    case RungKind::hits:
      run_hits(rung, result);
      break;
    case RungKind::leaving:
      run_leaving(rung, result);
      break;
    case RungKind::picture:
      // A pixel is several rays.
      result.ours = rung.picture({*context_, std::max(options_.rays / 16, 1024U), options_.double_precision});
      break;
  }
  result.broken = broken_bounds(case_name, rung.name, result.ours);
  if (result.packets) {
    for (const std::string& broken : broken_bounds(case_name, rung.name, *result.packets)) {
      result.broken.push_back("in packets " + broken);
    }
    const double most = most_allowed(case_name, rung.name, kOtherBits) * static_cast<double>(result.ours.rays);
    if (static_cast<double>(result.other_bits) > most) {
      result.broken.push_back(fmt::format("{} {} of {}", kOtherBits, result.other_bits, result.ours.rays));
    }
  }
  return result;
}

}  // namespace hemiray::stability
