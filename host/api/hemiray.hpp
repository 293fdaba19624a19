// hemiray as a library: a portable OpenCL renderer. This one header is all a user includes; it needs C++20 and nothing
// else. Errors are exceptions of class hemiray::Failure. Nothing here is thread-safe unless it says so.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace hemiray::api {

/// What went wrong: input (bad file or option: the message names the place) or device (OpenCL or system).
class Failure : public std::runtime_error {
 public:
  enum class Kind { input, device };
  Failure(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  [[nodiscard]] Kind kind() const noexcept { return kind_; }

 private:
  Kind kind_;
};

/// One OpenCL device in use. `selector` is an index, "cpu", "gpu" or part of a name; empty: HEMIRAY_DEVICE, else the
/// first usable GPU, else the first usable device. Move-only.
class Context {
 public:
  explicit Context(const std::string& selector = "");
  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;
  ~Context();

  [[nodiscard]] std::string device_name() const;

  struct Data;
  [[nodiscard]] Data& data() const { return *data_; }

 private:
  std::unique_ptr<Data> data_;
};

/// A ray; hits count in the open interval (t_min, t_max), in lengths of `direction`, which may have any length but
/// zero.
struct Ray {
  float origin[3];  ///< [m]
  float t_min;
  float direction[3];
  float t_max;
};

inline constexpr std::uint32_t kNoPrimitive = 0xffffffffU;

/// A ray's closest hit.
struct Hit {
  float t;                  ///< [lengths of the ray's direction]
  float u, v;               ///< barycentric weights of the triangle's second and third vertex; not for other surfaces
  std::uint32_t primitive;  ///< triangles in file order, then spheres, shapes, planes; kNoPrimitive for a miss
  [[nodiscard]] bool found() const { return primitive != kNoPrimitive; }
};

/// A scene, validated and complete: a file without camera or light has got a default one (see notes()). Copies share
/// the data, which never change.
class Scene {
 public:
  /// Loads .json, .gltf, .glb, .obj or .ply.
  static Scene load(const std::string& file);

  /// Triangles in the scene, objects counted as often as they are placed.
  [[nodiscard]] std::uint64_t triangle_count() const;
  /// Defaults taken and features not supported, one line each.
  [[nodiscard]] std::vector<std::string> notes() const;
  /// The camera's ray through (x, y) of its picture, (0, 0) top left, (1, 1) bottom right; aspect = width / height.
  [[nodiscard]] Ray camera_ray(double x, double y, double aspect = 1.0) const;

  struct Data;
  [[nodiscard]] const Data& data() const { return *data_; }

 private:
  Scene() = default;
  std::shared_ptr<const Data> data_;
};

enum class Engine { wavefront, megakernel };

struct RenderOptions {
  Engine engine = Engine::wavefront;
  int width = 0;   ///< [pixels]; 0: the scene's own size
  int height = 0;  ///< [pixels]; 0: the scene's own size
  int samples_per_pixel = 4;
  int depth = -1;  ///< bounces of mirrors and glass, 0 to 64; negative: the scene's own
  std::uint32_t seed = 0;
  bool strict = false;  ///< same bits from both engines
  /// Called now and then with the share done in [0, 1]; returning false ends the render after the current pass.
  std::function<bool(double)> on_progress;
};

/// A picture of named layers: "" (beauty: R, G, B, A), "depth", "normal", "albedo", "id", "direct", "reflection",
/// "refraction"; linear Rec. 709 radiance [W/m^2/sr], depth in metres. Copies share the data, which never change.
class Image {
 public:
  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  [[nodiscard]] std::vector<std::string> layer_names() const;
  [[nodiscard]] std::vector<std::string> channel_names(const std::string& layer) const;
  /// Row-major from the top left, channels interleaved.
  [[nodiscard]] std::span<const float> layer(const std::string& name = "") const;
  void write_exr(const std::string& file) const;
  /// sRGB, made brighter by `exposure` stops.
  void write_png(const std::string& file, double exposure = 0.0) const;

  struct Data;
  explicit Image(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

 private:
  std::shared_ptr<const Data> data_;
};

/// Renders the scene by Whitted ray tracing.
[[nodiscard]] Image render(Context& context, const Scene& scene, const RenderOptions& options = {});

/// The scene's acceleration structure on the device, for arrays of rays. The Context must outlive it. Move-only.
class Accel {
 public:
  Accel(Context& context, const Scene& scene);
  Accel(Accel&&) noexcept;
  Accel& operator=(Accel&&) noexcept;
  ~Accel();

  /// The closest hit of each ray; ties go to the smaller primitive.
  [[nodiscard]] std::vector<Hit> intersect(std::span<const Ray> rays) const;
  /// 1 for each ray that meets anything, else 0.
  [[nodiscard]] std::vector<std::uint32_t> occluded(std::span<const Ray> rays) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace hemiray::api

#ifndef HEMIRAY_BUILDING_LIBRARY
namespace hemiray {
using namespace api;
}
#endif
