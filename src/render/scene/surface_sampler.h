// surface_sampler.h - computes the colour and opacity of a surface at a fragment from vertex colours and
// textures, for the CPU reference. It samples in double precision with its own code. Only the texels are
// those of the device.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pellucid/raster.h"
#include "pellucid/shading.h"
#include "render/scene/texture_levels.h"

namespace pellucid::render {

class SurfaceSampler {
 public:
  // Keeps references to both arguments.
  SurfaceSampler(const RenderScene& scene, const Camera& camera);
  // Returns nothing where the fragment is cut out.
  [[nodiscard]] std::optional<SurfaceLook> look_at(std::uint64_t pixel, NodeId node) const;

 private:
  using Color = std::array<double, 4>;
  using Place = std::array<double, 2>;  // texture coordinates, or pixels
  using Weights = std::array<double, 3>;

  // Returns the weights of a triangle's corners where the ray through a point of the image meets its plane.
  [[nodiscard]] Weights weights_at(const Place& point, const Triangle& triangle) const;
  [[nodiscard]] Place texcoord_at(const Place& point, const Triangle& triangle) const;
  [[nodiscard]] Color vertex_color(const Place& point, const Triangle& triangle) const;
  [[nodiscard]] Color texture_color(std::uint32_t texture, const Place& point,
                                    const Triangle& triangle) const;

  const RenderScene& scene_;
  const Camera& camera_;
  std::vector<TextureLevels> textures_;
};

}  // namespace pellucid::render
