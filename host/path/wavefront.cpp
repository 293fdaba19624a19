#include "host/path/wavefront.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "host/scene/features.hpp"
#include "shared/stages.def"

namespace hemiray {
namespace {

constexpr std::uint32_t kPointLights = HR_FEATURE_POINT_LIGHTS | HR_FEATURE_SPOT_LIGHTS;
constexpr std::uint32_t kOtherLights = HR_FEATURE_AREA_LIGHTS | HR_FEATURE_EMITTERS | HR_FEATURE_DIRECTIONAL_LIGHTS;
constexpr std::uint32_t kGroupRays = 16;  // of a packet, kernels/lib/packet_rays.h

struct Stage {
  const char* kernel;
  std::uint32_t feature;
};

#define HR_STAGE_ROW(feature, name, loads, stores) Stage{"path_" #name, HR_FEATURE_##feature},
constexpr std::array kStages = {HR_PATH_STAGES(HR_STAGE_ROW)};
#undef HR_STAGE_ROW

}  // namespace

void WavefrontEngine::StateArrays::add(Context& context, const char* name, shared::real4, std::uint32_t slots) {
  vectors_.emplace_back(context, name, slots * floats_a_real_);
  all.push_back(arg(name, vectors_.back()));
}
void WavefrontEngine::StateArrays::add(Context& context, const char* name, shared::uint4, std::uint32_t slots) {
  integer_vectors_.emplace_back(context, name, slots);
  all.push_back(arg(name, integer_vectors_.back()));
}
void WavefrontEngine::StateArrays::add(Context& context, const char* name, std::uint32_t, std::uint32_t slots) {
  integers_.emplace_back(context, name, slots);
  all.push_back(arg(name, integers_.back()));
}

WavefrontEngine::StateArrays::StateArrays(Context& context, const ProgramOptions& options, std::uint32_t slots)
    : floats_a_real_(options.double_precision ? 2 : 1) {
  using shared::float4;
  using shared::real4;
  using shared::uint;
  using shared::uint4;
#define HR_ADD_FIELD(group, feature, type, name)                                                  \
  if (HR_GROUP_##group != HR_GROUP_SUMS && has_feature(options.features, HR_FEATURE_##feature)) { \
    add(context, "path_" #name, type{}, slots);                                                   \
  }
  HR_PATH_STATE(HR_ADD_FIELD)
#undef HR_ADD_FIELD
  for (const Argument& field : all) {
    if (field.name == "path_ray_origin" || field.name == "path_ray_direction") rays.push_back(field);
  }
}

WavefrontEngine::WavefrontEngine(Context& context, Parallel& parallel, const ProgramOptions& options,
                                 std::uint32_t slots, int depth, const WaveTracing& tracing)
    : context_(&context),
      parallel_(&parallel),
      features_(options.features),
      slots_(slots),
      options_(options),
      tracing_(tracing),
      program_(context, "wavefront", {"path/queue.cl", "path/wavefront.cl", "path/finish.cl", "film/accumulate.cl"},
               options),
      sums_(context, features_, slots),
      state_(context, options, slots),
      branches_(context, options, slots, depth),
      next_stage_(context, "next_stage", slots),
      queue_(context, "queue", slots),
      queue_other_(context, "queue", slots),
      counts_(context, "queue counts", std::size_t{HR_STAGE_done} * context.profile().queue_chunks + 1) {
  if (context.profile().tail_paths > 0) {
    tail_rays_ = Buffer<shared::uint2>(context, "ray counts", std::min(slots, context.profile().tail_paths));
  }
}

bool WavefrontEngine::packs_shadows() const {
  return tracing_.packets && has_feature(features_, kPointLights) && !has_feature(features_, kOtherLights);
}

std::uint32_t WavefrontEngine::rounds_of_packets(std::uint32_t lights) const {
  if (!tracing_.packets) return 0;
  return packs_shadows() ? 2 + lights : 1;  // a surface's shadow rays take a round a light
}

bool WavefrontEngine::is_tail(std::uint32_t live, Round round) const {
  if (live > context_->profile().tail_paths) return false;
  if (tracing_.sort_from > 0 && live >= tracing_.sort_from) return false;
  return round.number > 0 && !round.in_packets;
}

std::vector<std::uint32_t> WavefrontEngine::compact_queue(std::uint32_t live) {
  const std::uint32_t chunks = context_->profile().queue_chunks;
  const Arguments common = arguments(arg("queue", queue_), arg("next_stage", next_stage_), arg("count", live));
  launch(*context_, program_.kernel("path_queue_count"), chunks, arguments(common, arg("counts", counts_)));
  parallel_->exclusive_scan(counts_, HR_STAGE_done * chunks);
  launch(*context_, program_.kernel("path_queue_emit"), chunks,
         arguments(common, arg("offsets", counts_), arg("queue_out", queue_other_)));
  std::swap(queue_, queue_other_);
  const std::vector<std::uint32_t> offsets = counts_.read();
  std::vector<std::uint32_t> starts;
  for (std::uint32_t stage = 0; stage <= HR_STAGE_done; stage++) starts.push_back(offsets[std::size_t{stage} * chunks]);
  return starts;
}

void WavefrontEngine::run_stage(std::size_t stage, std::uint32_t first, std::uint32_t items, Round round,
                                const Arguments& common) {
  const Arguments run = arguments(common, arg("queue", queue_), arg("first", first), arg("count", items));
  const bool camera_rays = stage == HR_STAGE_intersect_closest && round.number == 0;
  if (round.in_packets && camera_rays) return run_packets("path_intersect_closest_packets", items, run);
  if (round.in_packets && packs_shadows() && stage == HR_STAGE_intersect_shadow) {
    run_packets("path_answer_shadow_packets", items, run);
  }
  const bool incoherent = stage == HR_STAGE_intersect_closest && round.number > 0;
  if (incoherent && tracing_.sort_from > 0 && items >= tracing_.sort_from) {
    if (!sorter_) sorter_.emplace(*context_, *parallel_, slots_, tracing_.lo, tracing_.hi);
    sorter_->sort(queue_, first, items, state_.rays);
  }
  launch(*context_, program_.kernel(kStages[stage].kernel), items, run);
}

void WavefrontEngine::run_packets(const char* kernel, std::uint32_t rays, const Arguments& run) {
  const std::uint32_t groups = context_->profile().packet_groups;
  if (!packet_program_) {
    ProgramOptions options = options_;
    options.defines += fmt::format(" -DHR_PACKET_GROUPS={}", groups);
    packet_program_.emplace(*context_, "wavefront_packets", std::vector<std::string>{"path/packets.cl"}, options);
  }
  const std::uint32_t packet = kGroupRays * groups;
  launch(*context_, packet_program_->kernel(kernel), (rays + packet - 1) / packet, run);
}

RayCounts WavefrontEngine::finish_paths(std::uint32_t live, const Arguments& common) {
  launch(*context_, program_.kernel("path_finish"), live,
         arguments(common, arg("queue", queue_), arg("ray_counts", tail_rays_), arg("count", live)));
  RayCounts total;
  for (const shared::uint2& rays : tail_rays_.read(0, live)) {
    total.closest += rays.x;
    total.shadow += rays.y;
  }
  return total;
}

RayCounts WavefrontEngine::trace(shared::RenderParams params, std::uint32_t count, const Arguments& given) {
  params.slot_count = slots_;
  const Arguments common = arguments(given, state_.all, sums_.as_arguments(), branches_.as_arguments(),
                                     arg("next_stage", next_stage_), arg("params", params));
  RayCounts rays;
  queue_.write(slots_by_tile(params.first_pixel, count, params.width));
  run_stage(HR_STAGE_generate, 0, count, {}, common);
  std::vector<std::uint32_t> starts = compact_queue(count);
  for (Round round; starts.back() > 0; round.number++) {
    round.in_packets = round.number < rounds_of_packets(params.light_count);
    if (is_tail(starts.back(), round)) {
      const RayCounts tail = finish_paths(starts.back(), common);
      rays.closest += tail.closest;
      rays.shadow += tail.shadow;
      break;
    }
    for (std::size_t stage = 0; stage < kStages.size(); stage++) {
      const std::uint32_t items = starts[stage + 1] - starts[stage];
      if (items == 0 || !has_feature(features_, kStages[stage].feature)) continue;
      if (stage == HR_STAGE_intersect_closest) rays.closest += items;
      if (stage == HR_STAGE_intersect_shadow) rays.shadow += items;
      if (stage == HR_STAGE_gather) rays.closest += std::uint64_t{items} * params.gather_rays;
      run_stage(stage, starts[stage], items, round, common);
    }
    starts = compact_queue(starts.back());
  }
  return rays;
}

}  // namespace hemiray
