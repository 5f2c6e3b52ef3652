// Implements run_records.h: computes the identity of a run and stores its records.
#include "transparency/run_records.h"

#include <string_view>

#include "pellucid/checkpoint.h"

namespace pellucid {
namespace {

// Must be raised if, within one version of pellucid, a step computes something else or its record has another
// form.
constexpr std::uint32_t kRecordsFormat = 3;

std::vector<std::byte> bytes_of_options(const OrderOptions& options) {
  // Every member has a name here. So a new option does not compile until it is decided whether results depend
  // on it.
  const auto& [method, partition, distances, facing, occlusion, raster_size, tolerance, alpha, max_error,
               min_psnr, least_frame_time, max_buffers, min_buffers, priority, fruitless_rounds,
               upsample_from, refine_rounds, cache_size, cache_method, cache_slack, memory, seed, progress,
               checkpoints] = options;
  static_cast<void>(memory);
  static_cast<void>(progress);
  static_cast<void>(checkpoints);
  RecordWriter writer;
  writer(method, partition, distances, facing, occlusion, raster_size, tolerance, alpha, max_error,
         min_psnr.has_value(), min_psnr.value_or(0), least_frame_time, max_buffers, min_buffers, priority,
         fruitless_rounds, upsample_from.has_value(), upsample_from.value_or(0), refine_rounds, cache_size,
         cache_method, cache_slack, seed);
  return writer.take();
}

}  // namespace

RunRecords::RunRecords(const Mesh& mesh, const OrderOptions& options) : store_(options.checkpoints) {
  if (store_ == nullptr) return;
  run_ = run_identity(mesh, options);
  store_->begin_run(run_);
}

RunRecords RunRecords::part(const std::string& name) const {
  RunRecords records = *this;
  records.prefix_ += name + "-";
  return records;
}

std::optional<std::vector<std::byte>> RunRecords::load(const std::string& name) const {
  if (store_ == nullptr) return std::nullopt;
  return store_->load(run_, prefix_ + name);
}

void RunRecords::save(const std::string& name, std::vector<std::byte> bytes) const {
  if (store_ != nullptr) store_->save(run_, prefix_ + name, std::move(bytes));
}

void RunRecords::refuse(const std::string& name) const {
  if (store_ != nullptr) store_->refuse(run_, prefix_ + name);
}

void RunRecords::remove_others(const std::string& kept) const {
  if (store_ != nullptr) store_->remove_others(run_, prefix_ + kept);
}

std::string run_identity(const Mesh& mesh, const OrderOptions& options) {
  constexpr std::string_view kVersion = PELLUCID_VERSION;
  const std::vector<std::byte> settings = bytes_of_options(options);
  std::string digits;
  for (const std::uint64_t seed : {1U, 2U}) {
    std::uint64_t hash =
        hash_bytes(std::as_bytes(std::span(kVersion)), seed + kRecordsFormat * std::uint64_t{8});
    hash = hash_bytes(std::as_bytes(std::span(mesh.positions)), hash);
    hash = hash_bytes(std::as_bytes(std::span(mesh.normals)), hash);
    hash = hash_bytes(std::as_bytes(std::span(mesh.triangles)), hash);
    hash = hash_bytes(settings, hash);
    for (int shift = 60; shift >= 0; shift -= 4) digits += "0123456789abcdef"[(hash >> shift) & 0xFU];
  }
  return digits;
}

}  // namespace pellucid
