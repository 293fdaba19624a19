// Texture look-up: bilinear or nearest, wrap modes, sRGB decoded per texel before filtering.
#ifndef HR_LIB_TEXTURE_H
#define HR_LIB_TEXTURE_H

#include "lib/scene_view.h"
#include "lib/vec.h"

static inline uint wrap_coordinate(int i, uint size, uint mode) {
  const int n = (int)size;
  if (mode == HR_WRAP_CLAMP) return (uint)clamp(i, 0, n - 1);
  const int period = mode == HR_WRAP_MIRROR ? 2 * n : n;
  int k = i % period;
  if (k < 0) k += period;
  return (uint)(k < n ? k : period - 1 - k);
}

static inline real3 fetch_texel(const SceneView* view, const Texture* texture, int x, int y) {
  const uint ix = wrap_coordinate(x, texture->width, texture->wrap_u);
  const uint iy = wrap_coordinate(y, texture->height, texture->wrap_v);
  const uint texel = view->texels[texture->first_texel + iy * texture->width + ix];
  const uint r = texel & 255u, g = (texel >> 8) & 255u, b = (texel >> 16) & 255u;
  if (texture->flags & HR_TEXTURE_SRGB) {
    return (real3)(view->srgb_to_linear[r], view->srgb_to_linear[g], view->srgb_to_linear[b]);
  }
  return (real3)((real)r, (real)g, (real)b) * (REAL(1.0) / 255);
}

// Texture coordinates beyond this many repeats lose their fraction in single precision anyway.
#define HR_MAX_UV REAL(65536.0)

// rgb at uv; (0,0) is the top left corner.
static inline real3 sample_texture(const SceneView* view, uint index, real2 uv) {
  const Texture texture = view->textures[index];
  const real x = clamp(uv.x, -HR_MAX_UV, HR_MAX_UV) * (real)texture.width;
  const real y = clamp(uv.y, -HR_MAX_UV, HR_MAX_UV) * (real)texture.height;
  if (texture.flags & HR_TEXTURE_NEAREST) return fetch_texel(view, &texture, (int)floor(x), (int)floor(y));
  const real fx = floor(x - REAL(0.5)), fy = floor(y - REAL(0.5));
  const real wx = x - REAL(0.5) - fx, wy = y - REAL(0.5) - fy;
  const int ix = (int)fx, iy = (int)fy;
  const real3 top = fetch_texel(view, &texture, ix, iy) * (1 - wx) + fetch_texel(view, &texture, ix + 1, iy) * wx;
  const real3 bottom =
      fetch_texel(view, &texture, ix, iy + 1) * (1 - wx) + fetch_texel(view, &texture, ix + 1, iy + 1) * wx;
  return top * (1 - wy) + bottom * wy;
}

#endif
