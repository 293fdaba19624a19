// Wrap, decode, filter.
#include "tests/reference/reference_texture.hpp"

#include <cmath>

namespace hemiray::reference {

namespace {

long wrapped(long index, long size, Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return ((index % size) + size) % size;
    case Wrap::clamp:
      return index < 0 ? 0 : (index >= size ? size - 1 : index);
    case Wrap::mirror:
      break;
  }
  const long period = 2 * size;
  const long folded = ((index % period) + period) % period;
  return folded < size ? folded : period - 1 - folded;
}

double decoded(std::uint8_t byte, ColorSpace space) {
  const double c = static_cast<double>(byte) / 255.0;
  if (space == ColorSpace::linear) return c;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

DVec3 texel(const Texture& texture, long column, long row) {
  const long x = wrapped(column, texture.width, texture.wrap_u);
  const long y = wrapped(row, texture.height, texture.wrap_v);
  const std::uint8_t* rgba = &texture.rgba.at(static_cast<std::size_t>(y * texture.width + x) * 4);
  return {decoded(rgba[0], texture.color_space), decoded(rgba[1], texture.color_space),
          decoded(rgba[2], texture.color_space)};
}

}  // namespace

DVec3 sample_texture(const Texture& texture, const glm::dvec2& uv) {
  const double x = uv.x * texture.width;
  const double y = uv.y * texture.height;
  if (texture.filter == Filter::nearest) {
    return texel(texture, static_cast<long>(std::floor(x)), static_cast<long>(std::floor(y)));
  }
  const double left = std::floor(x - 0.5);
  const double top = std::floor(y - 0.5);
  const double fx = x - 0.5 - left;
  const double fy = y - 0.5 - top;
  const long i = static_cast<long>(left);
  const long j = static_cast<long>(top);
  const DVec3 upper = texel(texture, i, j) * (1.0 - fx) + texel(texture, i + 1, j) * fx;
  const DVec3 lower = texel(texture, i, j + 1) * (1.0 - fx) + texel(texture, i + 1, j + 1) * fx;
  return upper * (1.0 - fy) + lower * fy;
}

}  // namespace hemiray::reference
