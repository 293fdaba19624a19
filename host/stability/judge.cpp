#include "host/stability/judge.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "host/stability/implicit_oracle.hpp"
#include "host/stability/oracle.hpp"
#include "host/stability/shape_oracle.hpp"

namespace hemiray::stability {
namespace {

constexpr std::size_t kChunk = 4096;  // rays that a thread judges at a time, a multiple of kRaysFromOnePoint

// Adds what is to be said of one ray to each tracer's counts. One for each thread.
using JudgeOneRay = std::function<void(std::size_t ray, std::span<Tally> tallies)>;

using MakeJudge = std::function<JudgeOneRay()>;

MakeJudge judge_of_triangles(const FlatScene& flat, const Rays& rays, std::span<const Answers> answers) {
  return [oracle = std::make_shared<const Oracle>(flat), &rays, answers] {
    return
        [oracle, session = Oracle::Session(*oracle), &rays, answers](std::size_t i, std::span<Tally> tallies) mutable {
          const Truth truth = session.meet(rays.rays[i]);
          const bool inside = rays.inside[i] != 0 && !truth.empty();
          for (std::size_t k = 0; k < answers.size(); k++) {
            session.judge(rays.rays[i], truth, answers[k].hits[i], inside, tallies[k]);
          }
        };
  };
}

void count(const shared::QueryRay& ray, const ShapeVerdict& verdict, const shared::QueryHit& answer, Tally& tally) {
  tally.rays++;
  switch (verdict.fault) {
    case ShapeFault::off_surface:
    case ShapeFault::beyond_rim:
    case ShapeFault::before_start:
      tally.false_hit++;
      return;
    case ShapeFault::not_nearest:
      tally.wrong_surface++;
      tally.missed++;
      return;
    case ShapeFault::missed:
      tally.missed++;
      return;
    case ShapeFault::none:
      break;
  }
  if (!verdict.exact) {
    tally.borderline++;
  } else if (answer.primitive != HR_NO_PRIMITIVE) {
    const double off = std::abs(static_cast<double>(answer.t) - verdict.t);
    tally.worst_ulps = std::max(tally.worst_ulps, off / ulp_along(ray, verdict.t));
  }
}

MakeJudge judge_of_shapes(const FlatScene& flat, const Rays& rays, std::span<const Answers> answers) {
  const auto shapes = std::make_shared<const std::vector<ShapeOracle>>(flat.shapes.begin(), flat.shapes.end());
  const auto first = static_cast<std::uint32_t>(flat.triangles.size() + flat.spheres.size());
  return [=, &rays] {
    return [=, &rays](std::size_t i, std::span<Tally> tallies) {
      for (std::size_t k = 0; k < answers.size(); k++) {
        const shared::QueryHit& answer = answers[k].hits[i];
        count(rays.rays[i], judge_shapes(*shapes, first, rays.rays[i], answer), answer, tallies[k]);
      }
    };
  };
}

MakeJudge judge_of_implicit(const FlatScene& flat, const Rays& rays, std::span<const Answers> answers) {
  return [oracle = std::make_shared<const ImplicitOracle>(flat), &rays, answers] {
    return [oracle, &rays, answers](std::size_t i, std::span<Tally> tallies) {
      const ImplicitTruth truth = oracle->meet(rays.rays[i]);
      for (std::size_t k = 0; k < answers.size(); k++) {
        oracle->judge(rays.rays[i], truth, answers[k].hits[i], tallies[k]);
      }
    };
  };
}

MakeJudge judge_of(const FlatScene& flat, const Rays& rays, std::span<const Answers> answers) {
  if (flat.shapes.empty()) return judge_of_triangles(flat, rays, answers);
  return flat.tapes.empty() ? judge_of_shapes(flat, rays, answers) : judge_of_implicit(flat, rays, answers);
}

}  // namespace

Judged judge_all(const FlatScene& flat, const Rays& rays, std::span<const Answers> answers, unsigned threads) {
  const MakeJudge make_judge = judge_of(flat, rays, answers);
  Judged all;
  all.tallies.resize(answers.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      const JudgeOneRay judge = make_judge();
      std::vector<Tally> mine(answers.size());
      std::vector<std::uint32_t> missed;
      for (;;) {
        const std::size_t first = next.fetch_add(kChunk), end = std::min(rays.rays.size(), first + kChunk);
        if (first >= rays.rays.size()) break;
        for (std::size_t i = first; i < end; i++) {
          const std::uint64_t before = mine[0].missed;
          judge(i, mine);
          if (mine[0].missed > before) missed.push_back(static_cast<std::uint32_t>(i));
          for (std::size_t k = 0; k < answers.size(); k++) {
            const Answers& given = answers[k];
            const bool found = given.hits[i].primitive != HR_NO_PRIMITIVE;
            mine[k].any_hit += !given.occluded.empty() && (given.occluded[i] != 0) != found ? 1 : 0;
          }
        }
      }
      const std::scoped_lock lock(mutex);
      for (std::size_t k = 0; k < answers.size(); k++) all.tallies[k].add(mine[k]);
      all.missed.insert(all.missed.end(), missed.begin(), missed.end());
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
  std::sort(all.missed.begin(), all.missed.end());
  return all;
}

}  // namespace hemiray::stability
