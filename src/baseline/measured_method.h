// Describes a method that is measured: how it draws a mesh, which mesh, and what it costs. baselines.cpp
// makes these methods from meshes and order sets, and measure.cpp measures them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/baseline.h"

namespace pellucid {

struct MeasuredMethod {
  MethodReport report;
  DrawingMethod drawing;
  // Returns the order of a viewpoint, for overdraw. Empty: overdraw is not measured.
  std::function<std::span<const NodeId>(const Viewpoint&)> order;
  // Does what a renderer does on the CPU before it can draw a frame, and returns a value that depends on all
  // of it. Empty: nothing has to be done.
  std::function<std::uint64_t(const Viewpoint&)> frame_work{};
  std::shared_ptr<const Mesh> mesh{};  // a mesh of its own; null: the mesh of the subject
};

// Returns the order set of a subject as a method. The subject must outlive it.
MeasuredMethod order_set_method(const MeasureSubject& subject, std::uint32_t cache_size);
// Returns a method that draws `triangles` front to back from every viewpoint.
MeasuredMethod single_order_method(const Mesh& mesh, const std::string& name,
                                   std::vector<std::uint32_t> triangles, std::uint32_t cache_size);
// Returns the triangle order of the mesh, drawn as viewers draw it ("original").
MeasuredMethod stored_order_method(const Mesh& mesh, std::uint32_t cache_size);

// Return the baselines of the same names in measure_subjects(). They keep references to `mesh`.
MeasuredMethod cache_optimized(const Mesh& mesh, std::uint32_t cache_size);
MeasuredMethod cache_optimized_twins(const Mesh& mesh, const OrderSet& orders, std::uint32_t cache_size);
MeasuredMethod centroid_sort(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                             std::uint32_t cache_size);
// Return nothing, and append the reason to `notes`, if the mesh needs too much memory.
std::optional<MeasuredMethod> bsp_walk(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                       std::uint32_t cache_size, Progress* progress,
                                       std::vector<std::string>& notes);
std::optional<MeasuredMethod> presorted_lists(const Mesh& mesh, const PresortedOptions& options,
                                              std::span<const Viewpoint> viewpoints,
                                              std::vector<std::string>& notes);

// Returns the work of choosing an order as pellucid/runtime/select.h does it, and the size of its table.
std::function<std::uint64_t(const Viewpoint&)> selection_work(const OrderSet& orders);
std::uint64_t cell_table_bytes(const PartitionSpec& partition, std::size_t orders);

// Returns the mean CPU time of `work` on this thread over some of the viewpoints. Several passes are timed,
// and the fastest counts.
double nanoseconds_per_frame(const std::function<std::uint64_t(const Viewpoint&)>& work,
                             std::span<const Viewpoint> viewpoints);

}  // namespace pellucid
