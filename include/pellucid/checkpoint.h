// pellucid/checkpoint.h - finished parts of a long run, kept in a folder until the run has succeeded.
//
// A record is one file, NAME.RUN.record: NAME is the part, RUN stands for everything that the result depends
// on (order_mesh: the mesh, its options and the version of pellucid), so that a record is never used for
// another input. It appears whole or not at all, and carries a checksum: what is damaged is made anew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {

namespace platform {
class FileLock;
}

// May be used for several meshes one after the other. load, save and remove may be called from several
// threads at once.
class CheckpointStore {
 public:
  // Makes the folder where there is none (its parent must exist), takes it for this process alone until the
  // object goes, and removes what a killed process left half written. Throws Error{cannot_write} naming the
  // folder and the reason. Notes go to `progress` (may be null).
  explicit CheckpointStore(std::string folder, Progress* progress = nullptr);
  ~CheckpointStore();
  CheckpointStore(const CheckpointStore&) = delete;
  CheckpointStore& operator=(const CheckpointStore&) = delete;

  [[nodiscard]] const std::string& folder() const { return folder_; }

  // Notes how many records of the run are there, or that all that are there belong to other runs.
  void begin_run(const std::string& run);
  // The bytes that were saved; nothing where there is no record, or, with a note, a damaged one.
  std::optional<std::vector<std::byte>> load(const std::string& run, const std::string& name);
  // Throws Error{cannot_write} naming the file and the reason.
  void save(const std::string& run, const std::string& name, std::vector<std::byte> bytes);
  // Says that a record was sound but did not hold what was expected.
  void refuse(const std::string& run, const std::string& name);
  // Remove the run's records but one.
  void remove_others(const std::string& run, const std::string& kept);
  // Remove the records of all runs begun here: the last call, once the result is safe elsewhere. The folder
  // goes with its last record.
  void finish();

 private:
  void leave();
  [[nodiscard]] std::string path_of(const std::string& run, const std::string& name) const;
  [[nodiscard]] std::vector<std::string> records_of(const std::string& run) const;

  std::string folder_;
  Progress* progress_;
  std::unique_ptr<platform::FileLock> lock_;
  std::set<std::string> runs_;  // begun here
};

// 64 bits that any change of a byte changes: against damage and mistakes, not against malice.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed);

}  // namespace pellucid
