// From the caller's arrays to meshes and frames: see handles.h.
#include <cmath>

#include "c/handles.h"

namespace pellucid::c {
namespace {

constexpr std::uint32_t kPackedStride = 3 * sizeof(float);

std::uint32_t stride_of(const PellucidMesh& mesh) {
  const std::uint32_t stride = mesh.position_stride == 0 ? kPackedStride : mesh.position_stride;
  require(stride >= kPackedStride && stride % sizeof(float) == 0,
          "mesh: position_stride must be 0, or a multiple of 4 of at least 12");
  return stride;
}

}  // namespace

std::vector<Vec3f> positions_from(const float* positions, const PellucidMesh& mesh) {
  require(positions != nullptr || mesh.vertex_count == 0, "mesh: positions is null");
  const std::size_t step = stride_of(mesh) / sizeof(float);
  std::vector<Vec3f> copied(mesh.vertex_count);
  for (std::size_t v = 0; v < copied.size(); ++v) {
    const float* at = positions + v * step;
    copied[v] = {at[0], at[1], at[2]};
  }
  return copied;
}

std::vector<std::uint32_t> indices_from(const void* indices, std::uint32_t index_bytes, std::uint64_t count) {
  require(index_bytes == 2 || index_bytes == 4, "index_bytes must be 2 or 4");
  require(indices != nullptr || count == 0, "indices is null");
  if (index_bytes == 4) {
    const auto* first = static_cast<const std::uint32_t*>(indices);
    return {first, first + count};
  }
  const auto* first = static_cast<const std::uint16_t*>(indices);
  return {first, first + count};
}

Mesh mesh_from(const PellucidMesh* mesh) {
  require(mesh != nullptr, "mesh is null");
  Mesh copied;
  copied.positions = positions_from(mesh->positions, *mesh);
  const std::vector<std::uint32_t> indices =
      indices_from(mesh->indices, mesh->index_bytes, std::uint64_t{3} * mesh->triangle_count);
  copied.triangles.resize(mesh->triangle_count);
  for (std::size_t t = 0; t < copied.triangles.size(); ++t)
    copied.triangles[t] = {indices[3 * t], indices[3 * t + 1], indices[3 * t + 2]};
  return copied;
}

Facing facing_from(PellucidFacing facing) {
  require(facing == pellucid_facing_single || facing == pellucid_facing_duplicated,
          "facing: there is no such value");
  return facing == pellucid_facing_single ? Facing::single : Facing::duplicated;
}

std::vector<std::vector<Vec3f>> frames_from(const PellucidMesh& mesh, const PellucidPoses* poses) {
  if (poses == nullptr) return {positions_from(mesh.positions, mesh)};
  require(poses->frame_count > 0 && poses->positions != nullptr && poses->times != nullptr,
          "poses: there are no frames, or no times");
  std::vector<std::vector<Vec3f>> frames;
  for (std::uint32_t frame = 0; frame < poses->frame_count; ++frame) {
    require(
        std::isfinite(poses->times[frame]) && (frame == 0 || poses->times[frame] > poses->times[frame - 1]),
        "poses: times must be finite and strictly increasing");
    frames.push_back(positions_from(poses->positions[frame], mesh));
  }
  return frames;
}

}  // namespace pellucid::c
