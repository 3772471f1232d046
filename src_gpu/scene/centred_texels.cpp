#include "src_gpu/scene/centred_texels.hpp"

#include <algorithm>

#include "shared/spectra_layout.h"

namespace kiloband::opencl {
namespace {

KbFloat4 centred(const KbFloat4& texel) {
  if (texel.x == 0 && texel.y == 0) return texel;
  constexpr double centre = KB_TEXTURE_CENTRE_NM;
  const double product = texel.x * centre, slope = product + texel.y;
  return {texel.x, static_cast<float>(slope + product), static_cast<float>(slope * centre + texel.z),
          texel.w};
}

}  // namespace

std::vector<KbFloat4> centred_texels(const FlatScene& scene) {
  std::vector<KbFloat4> texels(scene.texels.size());
  std::ranges::transform(scene.texels, texels.begin(), centred);
  for (const KbTexture& texture : scene.textures) {
    if (!(texture.flags & KB_TEXTURE_NORMALS)) continue;
    const std::size_t first = texture.first_texel, count = std::size_t{texture.width} * texture.height;
    std::copy_n(&scene.texels[first], count, &texels[first]);
  }
  return texels;
}

}  // namespace kiloband::opencl
