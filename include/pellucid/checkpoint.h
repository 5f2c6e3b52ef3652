// pellucid/checkpoint.h - saves finished parts of a long run in a folder, so that a later run can continue.
//
// In: the bytes of each finished part. Out: the same bytes after the process was stopped, or nothing if the
// record is missing or damaged. The records are removed when the run has succeeded.
//
// A record is one file named NAME.RUN.record. NAME names the part. RUN is a hash of everything that the
// result depends on, which for order_mesh() is the mesh, the options and the version of pellucid. A record is
// therefore never used for another input. Each record is written atomically and has a checksum. The caller
// computes a damaged part again.
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

// A folder of records. One store may serve several runs, one after the other. load(), save() and refuse() may
// be called from several threads at once.
class CheckpointStore {
 public:
  // Creates the folder if it does not exist (its parent must exist) and locks it for this process until the
  // store is destroyed. Removes partly written files that a killed process left. Sends notes to `progress`,
  // which may be null. Throws Error{cannot_write} that names the folder and the reason.
  explicit CheckpointStore(std::string folder, Progress* progress = nullptr);
  ~CheckpointStore();
  CheckpointStore(const CheckpointStore&) = delete;
  CheckpointStore& operator=(const CheckpointStore&) = delete;

  [[nodiscard]] const std::string& folder() const { return folder_; }

  // Starts a run. Notes how many records of this run exist, or that all existing records belong to other
  // runs.
  void begin_run(const std::string& run);
  // Returns the bytes that save() wrote, or nothing if there is no such record. Notes a damaged record and
  // returns nothing for it.
  std::optional<std::vector<std::byte>> load(const std::string& run, const std::string& name);
  // Writes a record. Throws Error{cannot_write} that names the file and the reason.
  void save(const std::string& run, const std::string& name, std::vector<std::byte> bytes);
  // Notes that a record is intact but does not have the expected content.
  void refuse(const std::string& run, const std::string& name);
  // Removes all records of the run except the one named `kept`.
  void remove_others(const std::string& run, const std::string& kept);
  // Removes the records of all runs that were begun with this store, and the folder if it is then empty. This
  // is the last call, after the result has been written elsewhere.
  void finish();

 private:
  void leave();
  [[nodiscard]] std::string path_of(const std::string& run, const std::string& name) const;
  [[nodiscard]] std::vector<std::string> records_of(const std::string& run) const;

  std::string folder_;
  Progress* progress_;
  std::unique_ptr<platform::FileLock> lock_;
  std::set<std::string> runs_;  // runs that were begun with this store
};

// Returns a 64-bit hash of the bytes. It detects damage and mistakes; it does not resist deliberate
// collisions.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed);

}  // namespace pellucid
