#include "host/path/wavefront.hpp"

#include <array>
#include <utility>

#include "shared/stages.def"

namespace hemiray {
namespace {

struct Stage {
  const char* kernel;
  std::uint32_t feature;
};

#define HR_STAGE_ROW(feature, name, loads, stores) Stage{"path_" #name, HR_FEATURE_##feature},
constexpr std::array kStages = {HR_PATH_STAGES(HR_STAGE_ROW)};
#undef HR_STAGE_ROW

}  // namespace

void WavefrontEngine::StateArrays::add(Context& context, const char* name, shared::real4, std::uint32_t slots) {
  vectors_.emplace_back(context, name, slots);
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

WavefrontEngine::StateArrays::StateArrays(Context& context, std::uint32_t features, std::uint32_t slots) {
  using shared::real4;
  using shared::uint;
  using shared::uint4;
#define HR_ADD_FIELD(group, feature, type, name)                                          \
  if (HR_GROUP_##group != HR_GROUP_SUMS && has_feature(features, HR_FEATURE_##feature)) { \
    add(context, "path_" #name, type{}, slots);                                           \
  }
  HR_PATH_STATE(HR_ADD_FIELD)
#undef HR_ADD_FIELD
}

WavefrontEngine::WavefrontEngine(Context& context, Parallel& parallel, const ProgramOptions& options,
                                 std::uint32_t slots, int depth)
    : context_(&context),
      parallel_(&parallel),
      features_(options.features),
      slots_(slots),
      program_(context, "wavefront", {"path/queue.cl", "path/wavefront.cl", "film/accumulate.cl"}, options),
      sums_(context, features_, slots),
      state_(context, features_, slots),
      branches_(context, features_, slots, depth),
      next_stage_(context, "next_stage", slots),
      queue_(context, "queue", slots),
      queue_other_(context, "queue", slots),
      counts_(context, "queue counts", std::size_t{HR_STAGE_done} * context.profile().queue_chunks + 1) {}

std::vector<std::uint32_t> WavefrontEngine::compact_queue(std::uint32_t live, bool is_identity) {
  const std::uint32_t chunks = context_->profile().queue_chunks;
  const Arguments common = arguments(arg("queue", queue_), arg("next_stage", next_stage_), arg("count", live),
                                     arg("is_identity", std::uint32_t{is_identity}));
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

RayCounts WavefrontEngine::trace(shared::RenderParams params, std::uint32_t count, const Arguments& given) {
  params.slot_count = slots_;
  const Arguments common = arguments(given, state_.all, sums_.as_arguments(), branches_.as_arguments(),
                                     arg("next_stage", next_stage_), arg("params", params));
  const auto run_stage = [&](std::size_t stage, std::uint32_t first, std::uint32_t items) {
    launch(*context_, program_.kernel(kStages[stage].kernel), items,
           arguments(common, arg("queue", queue_), arg("first", first), arg("count", items)));
  };
  RayCounts rays;
  // The camera rays need no queue of their own: `generate` runs on slots in order. Whatever order the last wave left
  // in the queue is a permutation of other slots, so the first compaction starts from the identity.
  std::vector<std::uint32_t> identity(count);
  for (std::uint32_t i = 0; i < count; i++) identity[i] = i;
  queue_.write(identity);
  run_stage(HR_STAGE_generate, 0, count);
  std::vector<std::uint32_t> starts = compact_queue(count, true);
  while (starts.back() > 0) {
    for (std::size_t stage = 0; stage < kStages.size(); stage++) {
      const std::uint32_t items = starts[stage + 1] - starts[stage];
      if (items == 0 || !has_feature(features_, kStages[stage].feature)) continue;
      if (stage == HR_STAGE_intersect_closest) rays.closest += items;
      if (stage == HR_STAGE_intersect_shadow) rays.shadow += items;
      run_stage(stage, starts[stage], items);
    }
    starts = compact_queue(starts.back(), false);
  }
  return rays;
}

}  // namespace hemiray
