// One measured thing: how it is drawn, on which mesh, and what it costs.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/baseline.h"

namespace pellucid {

struct Contender {
  MethodReport report;
  DrawingMethod method;
  std::function<std::span<const NodeId>(const Viewpoint&)> sequence;  // for overdraw; empty: not counted
  // What a renderer does on the CPU before it can draw a frame; returns something that depends on all of it.
  // Empty: nothing.
  std::function<std::uint64_t(const Viewpoint&)> frame_work{};
  std::shared_ptr<const Mesh> mesh{};  // a mesh of its own; null: the subject's
};

// What all ways of drawing have in common: the sequences that they may draw, as index data and through a
// vertex cache.
MethodReport cache_report(const Mesh& mesh, std::span<const NodeSequence> sequences, MethodKind kind,
                          std::uint32_t cache_size);
std::uint64_t bytes_of_indices(const Mesh& mesh, std::uint64_t triangles);
// Whole triangles as stored.
NodeSequence front_nodes(std::span<const std::uint32_t> triangles);

// The choice of an order, as pellucid/runtime/select.h makes it, and the table that it needs.
std::function<std::uint64_t(const Viewpoint&)> selection_work(const OrderSet& orders);
std::uint64_t cell_table_bytes(const PartitionSpec& partition, std::size_t orders);

// Mean time of `work` over some of the viewpoints: thread CPU time, the least of several passes.
double nanoseconds_per_frame(const std::function<std::uint64_t(const Viewpoint&)>& work,
                             std::span<const Viewpoint> viewpoints);

// The rivals that order anew in every frame, or nearly so. `notes` gets a line instead where one gives up.
Contender centroid_sort(const Mesh& mesh, std::span<const Viewpoint> viewpoints, std::uint32_t cache_size);
std::optional<Contender> bsp_walk(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                  std::uint32_t cache_size, Progress* progress,
                                  std::vector<std::string>& notes);
std::optional<Contender> presorted_lists(const Mesh& mesh, const PresortedOptions& options,
                                         std::span<const Viewpoint> viewpoints,
                                         std::vector<std::string>& notes);

}  // namespace pellucid
