// pellucid/pellucid.h - orders a mesh in memory or in a file, and selects an order in every frame.
//
// In: the arrays of a mesh, or a model file. Out: an OrderedMesh, which holds a few draw orders of the
// triangles, returns all of them as one index buffer, and says in every frame which of them to draw. Most
// programs need only this header.
//
//   #include <pellucid/pellucid.h>
//
//   // Once: order a translucent mesh, and upload all its orders as one index buffer.
//   std::vector<pellucid::Vec3f> positions = ...;  // one for each vertex, in the mesh's own space
//   std::vector<std::uint32_t> indices = ...;      // three for each triangle
//   pellucid::OrderedMesh ordered = pellucid::order({positions, indices}, {.max_error = 0.001});
//   pellucid::IndexBuffer buffer = ordered.index_buffer(pellucid::SortDirection::back_to_front);
//   upload(buffer.bytes, buffer.bytes_per_index);  // 2 bytes for each index where the vertices allow, else 4
//
//   // In every frame: choose the order for this camera, in about 150 ns.
//   pellucid::DrawOrder order = ordered.select(world_from_mesh, camera_position);
//   pellucid::IndexRange range = buffer.range(order);
//   draw_indexed(range.first, range.count);        // blending on, back faces culled, depth writes off
//
//   // The same for an opaque mesh, and for the translucent meshes of a file:
//   pellucid::OrderedMesh opaque = pellucid::reduce_overdraw({positions, indices});
//   pellucid::Model model = pellucid::read("glass.glb");
//   pellucid::order(model);
//   pellucid::write(model, "ordered.glb");
//
// CONVENTIONS
//   Space    Right-handed, counter-clockwise front faces, column-major matrices in double precision.
//            Distances are in bounding radii of the mesh (BoundingSphere), errors are shares of pixels, 0..1.
//   Errors   Functions throw pellucid::Error, whose kind() says what happened. Functions marked noexcept
//            cannot fail.
//   Threads  All cores are used; `pellucid::ThreadLimit limit(4);` allows fewer while it lives. The same
//            input, options and seed give the same result for any number of threads. The `progress` member
//            of options reports progress and can stop the work.
//
// Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, and for overdraw Han, Sander,
// "Triangle Reordering for Efficient Rendering in Complex Scenes", JCGT 6(3), 2017.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/asset.h"
#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/mesh_view.h"
#include "pellucid/overdraw.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"

struct PellucidOrders;     // pellucid/runtime/select.h
struct PellucidKeyframes;  // also there

namespace pellucid {

// ------------------------------------------------------------------------------------------ an ordered mesh

// One of the orders of an OrderedMesh.
struct DrawOrder {
  std::uint32_t index = 0;   // 0 .. order_count() - 1; order_count() is the fallback
  bool is_fallback = false;  // the orders are not valid for this camera, so the image has errors
  bool operator==(const DrawOrder&) const = default;
};

// A run of an index buffer, in indices: the arguments of an indexed draw call.
struct IndexRange {
  std::uint32_t first = 0, count = 0;
};

// How many bits an index has. automatic: as few as bytes_per_index() of pellucid/sequencing.h allows.
enum class IndexWidth { automatic, bits_32 };

// All orders of a mesh, one after the other, the fallback last.
struct IndexBuffer {
  std::uint32_t bytes_per_index = 4;  // 2 or 4, in the byte order of this machine
  std::vector<std::byte> bytes;
  std::vector<IndexRange> ranges;  // by DrawOrder::index
  // Throws Error{bad_argument} for an order that the buffer does not hold.
  [[nodiscard]] const IndexRange& range(const DrawOrder& order) const;
};

// What was found in the mesh, and how good the orders are. Orders from a file have only the measured error,
// if the file contains it.
struct OrderedMeshReport {
  MeshReport mesh;            // what was found in the given mesh
  std::uint64_t dropped = 0;  // triangles that were left out because they draw nothing, or repeat another
  // Transparency: share of covered pixels in a wrong order, over held-out viewpoints. Unset: not measured.
  std::optional<double> measured_error;
  double violated_weight = 0;  // transparency: share of the overlapped area that is drawn in the wrong order
  double overdraw = 0;         // overdraw: fragments shaded for each covered pixel, over the training views
  double seconds = 0;          // that ordering took
};

// The orders of one mesh. They never change, so threads may share an object; copies share their data. The
// orders are for blending (OrderPurpose::transparency) or for opaque meshes with a depth test
// (OrderPurpose::overdraw).
class OrderedMesh {
 public:
  // Takes orders that another module made or read; their nodes refer to mesh.triangles. Throws
  // Error{bad_argument} where they do not fit the mesh or their own table, so that no index is ever out of
  // range.
  OrderedMesh(OrderSet orders, const Mesh& mesh, const OrderedMeshReport& report);
  // There is no move: a moved-from object would hold nothing.
  OrderedMesh(const OrderedMesh&) = default;
  OrderedMesh& operator=(const OrderedMesh&) = default;
  ~OrderedMesh() = default;

  [[nodiscard]] std::uint32_t order_count() const noexcept;  // without the fallback
  [[nodiscard]] DrawOrder fallback() const noexcept;
  [[nodiscard]] std::uint32_t vertex_count() const noexcept;
  [[nodiscard]] const std::vector<Triangle>& triangles() const noexcept;  // of the given mesh
  [[nodiscard]] const OrderSet& orders() const noexcept;  // purpose, valid range, sphere, nodes
  [[nodiscard]] const OrderedMeshReport& report() const noexcept;

  // Returns all orders and the fallback in one buffer. Without a direction, transparency orders run back to
  // front, for "over" blending, and overdraw orders front to back. If both sides of the mesh are drawn, the
  // orders also have a flipped copy of every triangle whose back can be seen: cull back faces when you draw
  // them. Throws Error{bad_argument} for 2^32 indices or more, and for overdraw orders back to front. Takes
  // O(indices).
  [[nodiscard]] IndexBuffer index_buffer(IndexWidth width = IndexWidth::automatic) const;
  [[nodiscard]] IndexBuffer index_buffer(SortDirection direction,
                                         IndexWidth width = IndexWidth::automatic) const;

  // Writes one order to the caller's memory, which may be a mapped buffer because it is never read. Throws
  // Error{bad_argument} unless `to` has exactly index_count(order) elements of a type that can hold the
  // indices (see bytes_per_index()), and for overdraw orders back to front.
  [[nodiscard]] std::uint64_t index_count(const DrawOrder& order) const;
  void copy_indices(const DrawOrder& order, SortDirection direction, std::span<std::uint16_t> to) const;
  void copy_indices(const DrawOrder& order, SortDirection direction, std::span<std::uint32_t> to) const;

  // Returns the order that draws the mesh for a camera at `eye`, or for an orthographic camera that looks
  // along `forward`, both in world space. Transparency: the fallback where the camera is nearer or farther
  // than the valid range (by default, inside the bounding sphere), and for a singular matrix or NaN.
  // Overdraw: never the fallback, because every order draws the right image. The answers are those of
  // runtime/select.h. Takes O(level of the partition) and allocates nothing.
  [[nodiscard]] DrawOrder select(const Mat4& world_from_mesh, const Vec3d& eye) const noexcept;
  [[nodiscard]] DrawOrder select_orthographic(const Mat4& world_from_mesh,
                                              const Vec3d& forward) const noexcept;
  // Do the same at a time (seconds) of an animation, with the table of the nearest key frame. `animation` is
  // an index into orders().animations. If there is no such animation, they return the same as without a
  // time.
  [[nodiscard]] DrawOrder select(double time, const Mat4& world_from_mesh, const Vec3d& eye,
                                 std::size_t animation = 0) const noexcept;
  [[nodiscard]] DrawOrder select_orthographic(double time, const Mat4& world_from_mesh, const Vec3d& forward,
                                              std::size_t animation = 0) const noexcept;

  // Return what the functions of pellucid/runtime/select.h read, for programs that select with that header
  // alone. fallback_order is PELLUCID_NO_ORDER. The arrays exist as long as this object or a copy of it. If
  // there is no such animation, keyframes() returns a count of 0.
  [[nodiscard]] const PellucidOrders& selector() const noexcept;
  [[nodiscard]] const PellucidKeyframes& keyframes(std::size_t animation = 0) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// --------------------------------------------------------------------------------------------- order a mesh

// Orders a static translucent mesh for blending. Triangles that draw nothing (a corner is NaN or infinite, no
// area) are left out and counted in report(); options.facing says whether back faces are drawn, too. Takes
// seconds to minutes: about linear in triangles up to 24,000, which is where upsampling begins. Throws
// Error{bad_argument} for an index out of range, Error{nothing_to_do} where no triangle is left, and as
// order_mesh() does.
OrderedMesh order(const MeshView& mesh, const OrderOptions& options = {}, const CleanOptions& cleaning = {});
// Does the same for a mesh that was read from a file: triangles with an index out of range are left out and
// counted, too. Messages of errors begin with `name`.
OrderedMesh order_any_mesh(const Mesh& mesh, const OrderOptions& options = {},
                           const CleanOptions& cleaning = {}, const std::string& name = "mesh");

// Orders an opaque mesh to reduce overdraw: the depth test then rejects most hidden fragments before they are
// shaded. With `poses`, each of which has a position for every vertex of the mesh, the orders are for these
// key frames (select with a time), and the mesh is the model at rest. Every order contains all triangles.
// With Facing::duplicated, the order is made for drawing without culling. Throws Error{bad_argument} for an
// index out of range and for times that are not finite and strictly increasing as 32-bit floats, and
// Error{nothing_to_do} for a mesh without triangles.
OrderedMesh reduce_overdraw(const MeshView& mesh, const OverdrawOptions& options = {},
                            std::span<const Pose> poses = {}, Facing facing = Facing::single);

// ---------------------------------------------------------------------------------------------------- files
// A library that was built with PELLUCID_CORE_ONLY does not have these functions.

// Reads glTF, GLB, PLY, OBJ, STL or OFF; orders that it finds are in Primitive::orders. Throws
// Error{bad_input}.
Model read(const std::string& path, const ReadOptions& options = {});
// Writes glTF or GLB, by the extension of `path`, with the orders that the primitives have. Everything else
// in a glTF stays as it was. Throws as write_model() does.
WriteReport write(const Model& model, const std::string& path, const WriteOptions& options = {});

// Orders every primitive that is drawn with alpha blending and is neither skinned nor morphed, and keeps the
// orders in it.
// Returns the indices of these primitives. The facing comes from the materials of a glTF;
// for other formats it comes from the options. Throws Error{nothing_to_do} if there is no such primitive,
// or if one of them draws nothing. The model then stays as it was.
std::vector<std::uint32_t> order(Model& model, const OrderOptions& options = {});
// Orders one primitive, translucent or not, and keeps the orders in it.
OrderedMesh order_primitive(Model& model, std::uint32_t primitive, const OrderOptions& options = {});

// Returns the orders that a primitive has. Throws Error{nothing_to_do} if it has none.
OrderedMesh orders_of(const Model& model, std::uint32_t primitive);
// Replaces the orders of a primitive by transparency orders of its mesh. Throws Error{bad_argument} for
// orders of another mesh, and for overdraw orders, which depend on the whole model.
void set_orders(Model& model, std::uint32_t primitive, const OrderedMesh& orders);

}  // namespace pellucid
