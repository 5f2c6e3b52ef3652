// Internal to the C interface (pellucid/c/pellucid.h): what its handles hold, and the door between C and C++.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/asset.h"
#include "pellucid/c/pellucid.h"
#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"

struct PellucidOrderSet {
  pellucid::OrderSet orders;  // nodes refer to `triangles`
  std::vector<pellucid::Triangle> triangles;
  std::uint32_t vertex_count = 0;
  PellucidOrderStatistics statistics{};

  // What select.h reads: rows of cell_orders as the numbering of select.h wants them.
  std::vector<std::uint32_t> cell_orders, keyframe_cell_orders;
  std::vector<float> times, spheres;
};

struct PellucidModel {
  pellucid::Model model;
  // What is written, beside model.primitives: an order set, and the figures that came with it.
  std::vector<std::optional<pellucid::OrderSet>> orders;
  std::vector<std::optional<pellucid::OrderErrorRecord>> errors;
};

namespace pellucid::c {

// Keep the text for pellucid_last_error().
PellucidStatus fail(PellucidStatus status, const char* text) noexcept;
// Of the exception that is being handled.
PellucidStatus fail_with_current_exception() noexcept;

// Run `body`, and turn what it throws into a status.
template <class Body>
PellucidStatus guarded(const Body& body) noexcept {
  try {
    body();
    return pellucid_ok;
  } catch (...) {
    return fail_with_current_exception();
  }
}

// Throws Error{bad_argument}.
inline void require(bool holds, const char* otherwise) {
  if (!holds) throw Error(ErrorKind::bad_argument, otherwise);
}

// What the caller set over the defaults; the members that his header did not know of yet keep theirs.
template <class Options>
Options settled(const Options* given, void (*init)(Options*, std::size_t)) {
  Options options;
  init(&options, sizeof options);
  if (given == nullptr) return options;
  require(given->struct_size >= sizeof given->struct_size,
          "options: struct_size is not set: call init first");
  require(given->struct_size <= sizeof options, "options: they are of a later version than the library");
  std::memcpy(static_cast<void*>(&options), given, given->struct_size);
  return options;
}

// As much of a structure as the caller has room for.
template <class Structure>
void copy_out(const Structure& from, Structure* to, std::size_t size) {
  std::memcpy(static_cast<void*>(to), &from, std::min(size, sizeof from));
}

// Copies of the caller's arrays. Throws Error{bad_argument} for what is missing.
Mesh mesh_from(const PellucidMesh* mesh);
std::vector<Vec3f> positions_from(const float* positions, const PellucidMesh& mesh);
std::vector<std::uint32_t> indices_from(const void* indices, std::uint32_t index_bytes, std::uint64_t count);
Facing facing_from(PellucidFacing facing);

// One pose, or the caller's. Throws Error{bad_argument}.
std::vector<std::vector<Vec3f>> frames_from(const PellucidMesh& mesh, const PellucidPoses* poses);

// A handle for `orders` of `mesh`, with all that select.h needs. Release it, or it is freed.
std::unique_ptr<PellucidOrderSet> make_handle(OrderSet orders, const Mesh& mesh);

// The order that select.h would choose for a direction and, where the set has key frames, one of these.
std::uint32_t order_for(const PellucidOrderSet& set, const PellucidOrders& selector,
                        std::optional<std::uint32_t> key_frame, const Vec3d& direction);

}  // namespace pellucid::c
