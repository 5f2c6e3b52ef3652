// Keeps the results of finished steps of one order_mesh() call in a CheckpointStore, so that the next call
// can skip these steps. In: a value under a name. Out: the same value.
//
// A step that takes long is written as
//   checkpointed(records, "sequence-3", [&] { return order_of_cluster(3); })
// and is skipped if its record exists. Steps are deterministic, so a run that was continued ends with the
// same bytes as one that was not interrupted.
#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "base/record.h"
#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"

namespace pellucid {

class RunRecords {
 public:
  RunRecords() = default;  // keeps nothing
  // Keeps records in options.checkpoints, if there is one.
  RunRecords(const Mesh& mesh, const OrderOptions& options);

  // Returns the records whose names begin with `name` and a hyphen.
  [[nodiscard]] RunRecords part(const std::string& name) const;
  [[nodiscard]] bool kept() const { return store_ != nullptr; }

  [[nodiscard]] std::optional<std::vector<std::byte>> load(const std::string& name) const;
  void save(const std::string& name, std::vector<std::byte> bytes) const;
  void refuse(const std::string& name) const;
  // Removes all records but one: the records of finished steps that a later step has made superfluous.
  void remove_others(const std::string& kept) const;

 private:
  CheckpointStore* store_ = nullptr;
  std::string run_, prefix_;
};

// Returns 32 hexadecimal digits that identify the mesh, all options that the result depends on, and the
// version.
std::string run_identity(const Mesh& mesh, const OrderOptions& options);

// Returns the value that was recorded under this name, if there is one.
template <class Value>
std::optional<Value> recorded(const RunRecords& records, const std::string& name) {
  const std::optional<std::vector<std::byte>> bytes = records.load(name);
  if (!bytes) return std::nullopt;
  std::optional<Value> value(std::in_place);
  if (RecordReader(*bytes).read(*value)) return value;
  records.refuse(name);
  return std::nullopt;
}

template <class Value>
void record(const RunRecords& records, const std::string& name, const Value& value) {
  if (!records.kept()) return;
  RecordWriter writer;
  writer(value);
  records.save(name, writer.take());
}

// Returns the recorded value. If there is none, returns the value that `make` makes, and records it.
template <class Make>
auto checkpointed(const RunRecords& records, const std::string& name, const Make& make) {
  using Value = std::invoke_result_t<const Make&>;
  std::optional<Value> known = recorded<Value>(records, name);
  if (known) return std::move(*known);
  Value value = make();
  record(records, name, value);
  return value;
}

// ---------------------------------------------------------------------------------- members of public types

template <class Archive, RecordOf<PartitionSpec> T>
void fields(Archive& archive, T& spec) {
  archive(spec.kind, spec.level, spec.sample_level);
}

template <class Archive, RecordOf<BoundingSphere> T>
void fields(Archive& archive, T& sphere) {
  archive(sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius);
}

template <class Archive, RecordOf<KeyFrameTable> T>
void fields(Archive& archive, T& table) {
  archive(table.animation, table.times, table.spheres, table.cell_orders);
}

template <class Archive, RecordOf<OrderSet> T>
void fields(Archive& archive, T& set) {
  archive(set.purpose, set.partition, set.sphere, set.valid_from, set.valid_to, set.facing, set.orders,
          set.cell_orders, set.base_sequence, set.patch_offsets, set.model_ranks, set.animations);
}

template <class Archive, RecordOf<OrderStatistics> T>
void fields(Archive& archive, T& s) {
  archive(s.triangles, s.viewpoints, s.edges_per_viewpoint, s.edges_total, s.intersecting_pairs,
          s.cyclic_cells, s.dropped_edges, s.dropped_weight, s.violated_weight, s.violated_floor,
          s.violated_bound, s.regions, s.switches_per_turn, s.clusters_before_relaxation,
          s.clusters_lower_bound, s.iterations, s.measured_error, s.measured_psnr, s.seconds.graph,
          s.seconds.cluster, s.seconds.sequence, s.seconds.refine, s.seconds.total, s.peak_rss_bytes);
}

template <class Archive, RecordOf<OrderResult> T>
void fields(Archive& archive, T& result) {
  archive(result.orders, result.statistics);
}

}  // namespace pellucid
