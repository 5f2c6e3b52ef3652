// Fragments of posed meshes: see pose_raster.h.
#include "metric/pose_raster.h"

#include "overdraw/patches.h"

namespace pellucid {

std::vector<BoundingSphere> pose_spheres(const OverdrawSubject& subject) {
  Mesh mesh;
  mesh.triangles = subject.triangles;
  std::vector<BoundingSphere> spheres;
  for (const std::vector<Vec3f>& positions : subject.frames) {
    mesh.positions = positions;
    spheres.push_back(bounding_sphere(mesh));
  }
  return spheres;
}

PoseRaster::PoseRaster(const OverdrawSubject& subject, std::span<const BoundingSphere> spheres,
                       std::uint32_t size)
    : subject_(subject), spheres_(spheres), size_(size) {
  mesh_.triangles = subject.triangles;
}

void PoseRaster::draw(const OverdrawView& view,
                      const std::function<void(std::uint64_t, std::span<const Fragment>)>& visit) {
  if (frame_ != view.frame) {
    mesh_.positions = subject_.frames[view.frame];
    frame_ = view.frame;
  }
  const std::vector<std::uint8_t>& double_sided = subject_.double_sided;
  const bool all_culled = double_sided.empty();
  rasterize(mesh_, look_at_sphere(spheres_[view.frame], view.viewpoint, size_, size_),
            {all_culled ? Culling::back : Culling::none}, buffer_);
  const std::uint64_t pixels = std::uint64_t{size_} * size_;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    std::span<const Fragment> fragments = buffer_.pixel(p);
    if (!all_culled) {
      visible_.clear();
      for (const Fragment& fragment : fragments) {
        if ((fragment.node & 1U) == 0 || double_sided[fragment.node / 2] != 0) visible_.push_back(fragment);
      }
      fragments = visible_;
    }
    if (!fragments.empty()) visit(p, fragments);
  }
}

}  // namespace pellucid
