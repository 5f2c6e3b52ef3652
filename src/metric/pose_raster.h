// Rasterises the poses of a mesh. In: a subject with its poses, and a view of one pose. Out: the fragments of
// every covered pixel, by depth.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pellucid/metric.h"
#include "pellucid/raster.h"

namespace pellucid {

// A view of one pose.
struct OverdrawView {
  std::uint32_t frame = 0;  // the pose: index into OverdrawSubject::frames
  std::uint32_t cell = 0;   // vertex of the icosphere; unused for random viewpoints
  Viewpoint viewpoint;
};

// Draws poses of a subject. Use one object per thread.
class PoseRaster {
 public:
  PoseRaster(const OverdrawSubject& subject, std::span<const BoundingSphere> spheres, std::uint32_t size);
  // Calls visit(pixel, fragments) for every covered pixel. The fragments are sorted by depth; back faces of
  // single-sided triangles are left out.
  void draw(const OverdrawView& view,
            const std::function<void(std::uint64_t pixel, std::span<const Fragment>)>& visit);

 private:
  const OverdrawSubject& subject_;
  std::span<const BoundingSphere> spheres_;
  std::uint32_t size_;
  Mesh mesh_;
  std::uint32_t frame_ = 0xFFFFFFFFU;
  FragmentBuffer buffer_;
  std::vector<Fragment> visible_;
};

}  // namespace pellucid
