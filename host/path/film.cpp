#include "host/path/film.hpp"

#include <vector>

namespace hemiray {
namespace {

// Copies channels [first, first + channels) of float4 data, scaled.
Layer take(const std::string& name, std::vector<std::string> channels, const std::vector<shared::float4>& data,
           std::size_t first, float scale) {
  Layer layer{name, std::move(channels), {}};
  layer.data.reserve(data.size() * layer.channels.size());
  for (const shared::float4& v : data) {
    const float values[4] = {v.x, v.y, v.z, v.w};
    for (std::size_t c = 0; c < layer.channels.size(); c++) layer.data.push_back(values[first + c] * scale);
  }
  return layer;
}

}  // namespace

GeometryLayers::GeometryLayers(Context& context, int width, int height) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  normal_depth_ = {context, "aov_normal_depth", pixels};
  normal_depth_.clear();
  albedo_object_ = {context, "aov_albedo_object", pixels};
  albedo_object_.clear();
}

Arguments GeometryLayers::arguments() const {
  return hemiray::arguments(arg("aov_normal_depth", normal_depth_), arg("aov_albedo_object", albedo_object_));
}

Film::Film(Context& context, std::uint32_t features, int width, int height)
    : context_(&context), width_(width), height_(height), geometry_(context, width, height) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  direct_ = {context, "film_direct", pixels};
  direct_.clear();
  if (has_feature(features, HR_FEATURE_REFLECTION)) {
    reflection_ = {context, "film_reflection", pixels};
    reflection_.clear();
  }
  if (has_feature(features, HR_FEATURE_REFRACTION)) {
    refraction_ = {context, "film_refraction", pixels};
    refraction_.clear();
  }
}

void Film::accumulate(Kernel& kernel, const PathSums& sums, std::uint32_t first_pixel, std::uint32_t count) {
  Arguments film = arguments(arg("film_direct", direct_));
  if (!reflection_.name().empty()) film.push_back(arg("film_reflection", reflection_));
  if (!refraction_.name().empty()) film.push_back(arg("film_refraction", refraction_));
  launch(*context_, kernel, count,
         arguments(sums.as_arguments(), film, arg("first_pixel", first_pixel), arg("count", count)));
}

Image Film::develop(int passes) const {
  FilmData data{
      width_, height_, direct_.read(), {}, {}, geometry_.normal_depth().read(), geometry_.albedo_object().read()};
  if (!reflection_.name().empty()) data.reflection = reflection_.read();
  if (!refraction_.name().empty()) data.refraction = refraction_.read();
  return hemiray::develop(data, passes);
}

Image develop(const FilmData& data, int passes) {
  const float scale = passes > 0 ? 1.0F / static_cast<float>(passes) : 0.0F;
  const std::vector<shared::float4>& direct = data.direct;
  const std::vector<shared::float4> none(direct.size(), shared::float4{});
  const std::vector<shared::float4>& reflection = data.reflection.empty() ? none : data.reflection;
  const std::vector<shared::float4>& refraction = data.refraction.empty() ? none : data.refraction;
  Image image;
  image.width = data.width;
  image.height = data.height;
  const std::vector<std::string> rgb = {"R", "G", "B"};
  Layer beauty{"", {"R", "G", "B", "A"}, {}};
  beauty.data.reserve(direct.size() * 4);
  for (std::size_t i = 0; i < direct.size(); i++) {
    beauty.data.push_back((direct[i].x + reflection[i].x + refraction[i].x) * scale);
    beauty.data.push_back((direct[i].y + reflection[i].y + refraction[i].y) * scale);
    beauty.data.push_back((direct[i].z + reflection[i].z + refraction[i].z) * scale);
    beauty.data.push_back(direct[i].w * scale);
  }
  image.layers.push_back(std::move(beauty));
  image.layers.push_back(take("depth", {"Z"}, data.normal_depth, 3, 1.0F));
  image.layers.push_back(take("normal", {"X", "Y", "Z"}, data.normal_depth, 0, 1.0F));
  image.layers.push_back(take("albedo", rgb, data.albedo_object, 0, 1.0F));
  image.layers.push_back(take("id", {"id"}, data.albedo_object, 3, 1.0F));
  image.layers.push_back(take("direct", rgb, direct, 0, scale));
  image.layers.push_back(take("reflection", rgb, reflection, 0, scale));
  image.layers.push_back(take("refraction", rgb, refraction, 0, scale));
  return image;
}

}  // namespace hemiray
