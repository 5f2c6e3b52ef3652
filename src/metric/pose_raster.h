// The fragments of posed meshes, pixel by pixel.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pellucid/metric.h"
#include "pellucid/overdraw.h"
#include "pellucid/raster.h"

namespace pellucid {

// One view of one pose.
struct OverdrawView {
  std::uint32_t frame = 0;
  std::uint32_t cell = 0;  // of the icosphere's vertices
  Viewpoint viewpoint;
};

// Draws poses of a subject. One per thread.
class PoseRaster {
 public:
  PoseRaster(const OverdrawSubject& subject, std::span<const BoundingSphere> spheres, std::uint32_t size);
  // visit(fragments of a covered pixel, sorted by depth), without back faces of single-sided parts.
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
