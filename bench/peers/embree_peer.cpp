#include "bench/peers/embree_peer.hpp"

#include <embree3/rtcore.h>
#if defined(__SSE3__) || defined(__x86_64__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <array>
#include <atomic>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/base/clock.hpp"
#include "host/base/error.hpp"

namespace hemiray::bench {
namespace {

constexpr std::size_t kChunk = 4096;  // rays a thread takes at a time
constexpr std::size_t kStream = 128;  // rays a call of rtcIntersect1M

// Denormals are zero while one lives, in its thread.
class FlushDenormals {
 public:
#if defined(__SSE3__) || defined(__x86_64__)
  FlushDenormals() : before_(_mm_getcsr()) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _mm_setcsr(_mm_getcsr() | kDenormalsAreZero);
  }
  ~FlushDenormals() { _mm_setcsr(before_); }
#else
  FlushDenormals() = default;
  ~FlushDenormals() = default;
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__SSE3__) || defined(__x86_64__)
  static constexpr unsigned kDenormalsAreZero = 0x40;
  unsigned before_;
#endif
};

// Calls work(first, end) for all chunks of [0, count) on `threads` threads, this one among them.
template <typename Work>
void for_chunks(unsigned threads, std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    const FlushDenormals flush;
    for (std::size_t first = next.fetch_add(kChunk); first < count; first = next.fetch_add(kChunk)) {
      work(first, std::min(count, first + kChunk));
    }
  };
  std::vector<std::jthread> others;
  for (unsigned i = 1; i < threads; i++) others.emplace_back(run);
  run();
}

// Embree's queries come with room for a hit (closest hits) or without (any hit): what differs is in these overloads.

RTCRay& ray_of(RTCRayHit& query) { return query.ray; }
RTCRay& ray_of(RTCRay& query) { return query; }
auto& ray_of(RTCRayHit8& query) { return query.ray; }
auto& ray_of(RTCRay8& query) { return query; }
auto& ray_of(RTCRayHit16& query) { return query.ray; }
auto& ray_of(RTCRay16& query) { return query; }

template <typename Query>
void fill(Query& query, const shared::QueryRay& from) {
  RTCRay& to = ray_of(query);
  to.org_x = from.origin.x, to.org_y = from.origin.y, to.org_z = from.origin.z, to.tnear = from.origin.w;
  to.dir_x = from.direction.x, to.dir_y = from.direction.y, to.dir_z = from.direction.z, to.tfar = from.direction.w;
  to.time = 0.0F;
  to.mask = ~0U;
  to.id = to.flags = 0;
  if constexpr (std::is_same_v<Query, RTCRayHit>) {
    query.hit.primID = query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  }
}

template <typename Packet>
void fill_lane(Packet& query, std::size_t lane, const shared::QueryRay& from) {
  auto& to = ray_of(query);
  to.org_x[lane] = from.origin.x, to.org_y[lane] = from.origin.y, to.org_z[lane] = from.origin.z;
  to.tnear[lane] = from.origin.w;
  to.dir_x[lane] = from.direction.x, to.dir_y[lane] = from.direction.y, to.dir_z[lane] = from.direction.z;
  to.tfar[lane] = from.direction.w;
  to.time[lane] = 0.0F;
  to.mask[lane] = ~0U;
  to.id[lane] = to.flags[lane] = 0;
  if constexpr (requires { query.hit; }) {
    query.hit.primID[lane] = query.hit.geomID[lane] = query.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
}

std::uint32_t is_occluded(float t_far) { return t_far < 0 ? 1 : 0; }  // Embree sets -infinity

void read(const RTCRay& found, std::uint32_t& occluded) { occluded = is_occluded(found.tfar); }
void read(const RTCRayHit& found, shared::QueryHit& hit) {
  hit = {found.ray.tfar, found.hit.u, found.hit.v, found.hit.primID};
}
template <typename Packet>
void read_lane(const Packet& found, std::size_t lane, std::uint32_t& occluded) {
  occluded = is_occluded(found.tfar[lane]);
}
template <typename Packet>
void read_lane(const Packet& found, std::size_t lane, shared::QueryHit& hit) {
  hit = {found.ray.tfar[lane], found.hit.u[lane], found.hit.v[lane], found.hit.primID[lane]};
}

void ask(RTCScene scene, RTCIntersectContext& context, RTCRayHit& query) { rtcIntersect1(scene, &context, &query); }
void ask(RTCScene scene, RTCIntersectContext& context, RTCRay& query) { rtcOccluded1(scene, &context, &query); }
void ask(RTCScene scene, RTCIntersectContext& context, const int* valid, RTCRayHit8& query) {
  rtcIntersect8(valid, scene, &context, &query);
}
void ask(RTCScene scene, RTCIntersectContext& context, const int* valid, RTCRay8& query) {
  rtcOccluded8(valid, scene, &context, &query);
}
void ask(RTCScene scene, RTCIntersectContext& context, const int* valid, RTCRayHit16& query) {
  rtcIntersect16(valid, scene, &context, &query);
}
void ask(RTCScene scene, RTCIntersectContext& context, const int* valid, RTCRay16& query) {
  rtcOccluded16(valid, scene, &context, &query);
}
void ask(RTCScene scene, RTCIntersectContext& context, RTCRayHit* queries, unsigned count) {
  rtcIntersect1M(scene, &context, queries, count, sizeof(RTCRayHit));
}
void ask(RTCScene scene, RTCIntersectContext& context, RTCRay* queries, unsigned count) {
  rtcOccluded1M(scene, &context, queries, count, sizeof(RTCRay));
}

RTCIntersectContext context_for(bool coherent) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

// --- the ways of asking, for `count` rays ---

template <typename Query, typename Answer>
void trace_single(RTCScene scene, const shared::QueryRay* rays, Answer* answers, std::size_t count) {
  RTCIntersectContext context = context_for(false);
  for (std::size_t i = 0; i < count; i++) {
    Query query;
    fill(query, rays[i]);
    ask(scene, context, query);
    read(query, answers[i]);
  }
}

template <typename Packet, std::size_t kWidth, typename Answer>
void trace_packets(RTCScene scene, const shared::QueryRay* rays, Answer* answers, std::size_t count) {
  RTCIntersectContext context = context_for(true);
  alignas(64) std::array<int, kWidth> valid;
  valid.fill(-1);
  alignas(64) Packet query;
  for (std::size_t first = 0; first < count; first += kWidth) {
    for (std::size_t lane = 0; lane < kWidth; lane++) fill_lane(query, lane, rays[first + lane]);
    ask(scene, context, valid.data(), query);
    for (std::size_t lane = 0; lane < kWidth; lane++) read_lane(query, lane, answers[first + lane]);
  }
}

template <typename Query, typename Answer>
void trace_streams(RTCScene scene, const shared::QueryRay* rays, Answer* answers, std::size_t count) {
  RTCIntersectContext context = context_for(true);
  std::array<Query, kStream> queries;
  for (std::size_t first = 0; first < count; first += kStream) {
    const std::size_t size = std::min(kStream, count - first);
    for (std::size_t i = 0; i < size; i++) fill(queries[i], rays[first + i]);
    ask(scene, context, queries.data(), static_cast<unsigned>(size));
    for (std::size_t i = 0; i < size; i++) read(queries[i], answers[first + i]);
  }
}

// --- the scene ---

void check(RTCDevice device, std::string_view what) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw DeviceError("Embree: " + std::string(what) + " failed with error " + std::to_string(error));
}

// A copy of the triangles and Embree's scene over them.
class EmbreeScene {
 public:
  EmbreeScene(RTCBuildQuality quality, bool robust, unsigned threads) : quality_(quality), robust_(robust) {
    device_ = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    if (device_ == nullptr) throw DeviceError("Embree: no device");
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene() {
    if (scene_ != nullptr) rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  double build(const FlatScene& flat) {
    if (scene_ != nullptr) rtcReleaseScene(std::exchange(scene_, nullptr));
    positions_ = flat.positions;
    positions_.push_back(0.0F);  // Embree reads 16 bytes a vertex
    indices_.clear();
    for (const shared::uint4& t : flat.triangles) indices_.insert(indices_.end(), {t.x, t.y, t.z});

    scene_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene_, quality_);
    if (robust_) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, quality_);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions_.data(), 0,
                               3 * sizeof(float), flat.positions.size() / 3);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_.data(), 0,
                               3 * sizeof(std::uint32_t), flat.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    check(device_, "setting up the scene");

    const FlushDenormals flush;
    const double start = steady_ms();
    rtcCommitScene(scene_);
    const double taken = steady_ms() - start;
    check(device_, "building the scene");
    return taken;
  }

  [[nodiscard]] RTCScene handle() const { return scene_; }
  void check_errors() const { check(device_, "tracing"); }

 private:
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  RTCBuildQuality quality_;
  bool robust_;
  std::vector<float> positions_;
  std::vector<std::uint32_t> indices_;
};

RTCBuildQuality to_embree(EmbreeQuality quality) {
  return quality == EmbreeQuality::low      ? RTC_BUILD_QUALITY_LOW
         : quality == EmbreeQuality::medium ? RTC_BUILD_QUALITY_MEDIUM
                                            : RTC_BUILD_QUALITY_HIGH;
}

class EmbreePeer final : public Tracer {
 public:
  explicit EmbreePeer(const EmbreeSettings& settings) : settings_(settings) {}

  std::string name() const override {
    constexpr std::array<std::string_view, 4> kModes{"single", "packet8", "packet16", "stream"};
    return build_name() + "/" + std::string(kModes[static_cast<std::size_t>(settings_.mode)]);
  }
  std::string build_name() const override {
    constexpr std::array<std::string_view, 3> kQualities{"low", "medium", "high"};
    return "embree/" + std::string(kQualities[static_cast<std::size_t>(settings_.quality)]) +
           (settings_.robust ? "/robust" : "");
  }
  bool in_packets() const override { return settings_.mode != EmbreeMode::single; }

  double build(const FlatScene& flat) override {
    if (!scene_ || scene_.use_count() > 1) {
      scene_ = std::make_shared<EmbreeScene>(to_embree(settings_.quality), settings_.robust, settings_.threads);
    }
    return scene_->build(flat);
  }
  bool share_build(const Tracer& other) override {
    const auto* peer = dynamic_cast<const EmbreePeer*>(&other);
    if (peer == nullptr || peer->build_name() != build_name() || !peer->scene_) return false;
    scene_ = peer->scene_;
    return true;
  }

  void load_rays(std::span<const shared::QueryRay> rays) override {
    if (rays.size() % 64 != 0) throw std::logic_error("rays come in multiples of 64");
    rays_.assign(rays.begin(), rays.end());
    hits_.assign(rays.size(), {0.0F, 0.0F, 0.0F, HR_NO_PRIMITIVE});
    occlusions_.assign(rays.size(), 0);
  }
  void intersect() override { trace<RTCRayHit, RTCRayHit8, RTCRayHit16>(hits_.data()); }
  void occluded() override { trace<RTCRay, RTCRay8, RTCRay16>(occlusions_.data()); }
  std::vector<shared::QueryHit> hits() override { return hits_; }
  std::vector<std::uint32_t> occlusions() override { return occlusions_; }

 private:
  template <typename Query, typename Packet8, typename Packet16, typename Answer>
  void trace(Answer* answers) {
    constexpr std::array kWays{trace_single<Query, Answer>, trace_packets<Packet8, 8, Answer>,
                               trace_packets<Packet16, 16, Answer>, trace_streams<Query, Answer>};
    const auto way = kWays[static_cast<std::size_t>(settings_.mode)];
    if (!scene_) throw std::logic_error("rays before a build");
    for_chunks(settings_.threads, rays_.size(), [&](std::size_t first, std::size_t end) {
      way(scene_->handle(), rays_.data() + first, answers + first, end - first);
    });
    scene_->check_errors();
  }

  EmbreeSettings settings_;
  std::shared_ptr<EmbreeScene> scene_;
  std::vector<shared::QueryRay> rays_;
  std::vector<shared::QueryHit> hits_;
  std::vector<std::uint32_t> occlusions_;
};

}  // namespace

std::unique_ptr<Tracer> make_embree_peer(const EmbreeSettings& settings) {
  return std::make_unique<EmbreePeer>(settings);
}

std::string embree_version() {
  RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) throw DeviceError("Embree: no device");
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  rtcReleaseDevice(device);
  return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100);
}

}  // namespace hemiray::bench
