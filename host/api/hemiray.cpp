// The public API over the modules: conversions and nothing else.
#define HEMIRAY_BUILDING_LIBRARY
#include "host/api/hemiray.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "host/base/error.hpp"
#include "host/base/exr.hpp"
#include "host/base/png.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/path/render.hpp"
#include "host/scene/features.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/load.hpp"

namespace hemiray::api {

static_assert(sizeof(Ray) == sizeof(shared::QueryRay) && sizeof(Hit) == sizeof(shared::QueryHit));

struct Context::Data {
  explicit Data(const std::string& selector) : context(choose_device(selector)) {}
  hemiray::Context context;
};

struct Scene::Data {
  hemiray::Scene scene;
};

struct Image::Data {
  hemiray::Image image;
};

struct Accel::Data {
  Data(hemiray::Context& context, const hemiray::Scene& scene, const FlatScene& flat)
      : device_scene(context, flat, features_of(scene, flat, 0)),
        parallel(context),
        builder(context, parallel),
        accel(builder, device_scene),
        queries(context, device_scene, accel) {}
  DeviceScene device_scene;
  Parallel parallel;
  AccelBuilder builder;
  hemiray::Accel accel;
  RayQueries queries;
};

namespace {

// Runs `body` and turns hemiray's own errors into the API's.
template <typename Body>
auto guarded(Body&& body) -> decltype(body()) {
  try {
    return body();
  } catch (const Error& error) {
    throw Failure(error.code() == ExitCode::input ? Failure::Kind::input : Failure::Kind::device, error.what());
  }
}

std::vector<shared::QueryRay> to_query_rays(std::span<const Ray> rays) {
  std::vector<shared::QueryRay> queries;
  queries.reserve(rays.size());
  for (const Ray& r : rays) {
    queries.push_back(
        {{r.origin[0], r.origin[1], r.origin[2], r.t_min}, {r.direction[0], r.direction[1], r.direction[2], r.t_max}});
  }
  return queries;
}

const Layer& find_layer(const hemiray::Image& image, const std::string& name) {
  const Layer* layer = image.find(name);
  if (layer == nullptr) throw Failure(Failure::Kind::input, "the image has no layer '" + name + "'");
  return *layer;
}

}  // namespace

Context::Context(const std::string& selector)
    : data_(guarded([&selector] { return std::make_unique<Data>(selector); })) {}
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;
Context::~Context() = default;

std::string Context::device_name() const { return data_->context.device().name; }

Scene Scene::load(const std::string& file) {
  Scene scene;
  scene.data_ = guarded([&file] { return std::make_shared<const Data>(Data{load_scene(file)}); });
  return scene;
}

std::uint64_t Scene::triangle_count() const {
  std::uint64_t count = 0;
  for (const Object& object : data_->scene.objects) count += data_->scene.meshes[object.mesh].triangles.size();
  return count;
}

std::vector<std::string> Scene::notes() const { return data_->scene.notes; }

Ray Scene::camera_ray(double x, double y, double aspect) const {
  const Camera& camera = data_->scene.camera;
  const bool orthographic = camera.kind == CameraKind::orthographic;
  const double half_height =
      orthographic ? camera.height_m / 2.0 : std::tan(camera.fov_y_deg * std::numbers::pi / 360.0);
  const DVec3 on_plane((2.0 * x - 1.0) * half_height * aspect, (1.0 - 2.0 * y) * half_height, 0.0);
  const DVec3 local_origin = orthographic ? on_plane : DVec3(0.0);
  const DVec3 local_direction = orthographic ? DVec3(0.0, 0.0, -1.0) : glm::normalize(on_plane - DVec3(0.0, 0.0, 1.0));
  const Vec3 origin(camera.to_world * glm::dvec4(local_origin, 1.0));
  const Vec3 direction(camera.to_world * glm::dvec4(local_direction, 0.0));
  return {{origin.x, origin.y, origin.z}, 0.0F, {direction.x, direction.y, direction.z}, INFINITY};
}

Image render(Context& context, const Scene& scene, const RenderOptions& options) {
  hemiray::RenderOptions internal;
  internal.engine = options.engine == Engine::megakernel ? EngineKind::megakernel : EngineKind::wavefront;
  internal.width = options.width;
  internal.height = options.height;
  internal.spp = options.samples_per_pixel;
  internal.depth = options.depth;
  internal.seed = options.seed;
  internal.strict = options.strict;
  bool go_on = true;
  if (options.on_progress) {
    internal.on_progress = [&](double fraction, double) { go_on = options.on_progress(fraction) && go_on; };
    internal.should_stop = [&go_on] { return !go_on; };
  }
  return guarded([&] {
    RenderResult result = render_scene(context.data().context, scene.data().scene, internal);
    return Image(std::make_shared<const Image::Data>(Image::Data{std::move(result.image)}));
  });
}

int Image::width() const { return data_->image.width; }
int Image::height() const { return data_->image.height; }

std::vector<std::string> Image::layer_names() const {
  std::vector<std::string> names;
  for (const Layer& layer : data_->image.layers) names.push_back(layer.name);
  return names;
}

std::vector<std::string> Image::channel_names(const std::string& layer) const {
  return find_layer(data_->image, layer).channels;
}

std::span<const float> Image::layer(const std::string& name) const { return find_layer(data_->image, name).data; }

void Image::write_exr(const std::string& file) const {
  guarded([&] { hemiray::write_exr(file, data_->image); });
}

void Image::write_png(const std::string& file, double exposure) const {
  guarded([&] { hemiray::write_png(file, data_->image, "", exposure); });
}

Accel::Accel(Context& context, const Scene& scene)
    : data_(guarded([&] {
        const hemiray::Scene& internal = scene.data().scene;
        return std::make_unique<Data>(context.data().context, internal, flatten_scene(internal));
      })) {}
Accel::Accel(Accel&&) noexcept = default;
Accel& Accel::operator=(Accel&&) noexcept = default;
Accel::~Accel() = default;

std::vector<Hit> Accel::intersect(std::span<const Ray> rays) const {
  return guarded([&] {
    std::vector<Hit> hits;
    hits.reserve(rays.size());
    for (const shared::QueryHit& h : data_->queries.intersect(to_query_rays(rays))) {
      hits.push_back({h.t, h.u, h.v, h.primitive});
    }
    return hits;
  });
}

std::vector<std::uint32_t> Accel::occluded(std::span<const Ray> rays) const {
  return guarded([&] { return data_->queries.occluded(to_query_rays(rays)); });
}

}  // namespace hemiray::api
