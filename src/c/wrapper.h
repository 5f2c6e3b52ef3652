// Converts between the C interface (pellucid/c/pellucid.h) and C++: handles, errors, options, arrays and
// progress. In: what C passes. Out: what the functions of pellucid/pellucid.h take.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "pellucid/c/pellucid.h"
#include "pellucid/pellucid.h"

struct PellucidOrderSet {
  pellucid::OrderedMesh mesh;
};

struct PellucidModel {
  pellucid::Model model;
};

namespace pellucid::c {

// Keeps the text for pellucid_last_error().
PellucidStatus fail(PellucidStatus status, const char* text) noexcept;
// Keeps the text of the exception that is being handled, and returns its status.
PellucidStatus fail_with_current_exception() noexcept;

// Runs `body`, and turns what it throws into a status.
template <class Body>
PellucidStatus guarded(const Body& body) noexcept {
  try {
    body();
    return pellucid_ok;
  } catch (...) {
    return fail_with_current_exception();
  }
}

// Throws Error{bad_argument} with the text `otherwise` unless `holds` is true.
inline void require(bool holds, const char* otherwise) {
  if (!holds) throw Error(ErrorKind::bad_argument, otherwise);
}

// Returns the defaults with what the caller has set over them. Members that the caller's header did not have
// yet keep their defaults.
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

// Copies as much of a structure as the caller has room for.
template <class Structure>
void copy_out(const Structure& from, Structure* to, std::size_t size) {
  std::memcpy(static_cast<void*>(to), &from, std::min(size, sizeof from));
}

// Return views of the caller's arrays. They throw Error{bad_argument} for arrays that are missing.
MeshView view_of(const PellucidMesh* mesh);
IndexView view_of_indices(const void* indices, std::uint32_t index_bytes, std::uint64_t count);
std::vector<Pose> poses_of(const PellucidMesh& mesh, const PellucidPoses* poses);  // null: none
Facing facing_of(PellucidFacing facing);

// Passes progress on to the caller's function. The library reports often and from many threads, but the
// caller's function is called by one thread at a time, and at most every 20 ms within a stage.
class CallbackProgress final : public Progress {
 public:
  explicit CallbackProgress(const PellucidRun& run) : run_(run) {}

  void begin(std::string_view name, std::uint64_t total) override;
  void advance(std::uint64_t amount) override;
  [[nodiscard]] bool stop_requested() const override { return stopped_; }

  // Returns this object, or null if the caller has no function, as the options of the library take it.
  [[nodiscard]] Progress* pointer() { return run_.progress == nullptr ? nullptr : this; }

 private:
  void tell();  // calls the caller's function; requires the lock

  PellucidRun run_;
  std::mutex mutex_;
  std::string stage_;
  std::atomic<std::uint64_t> done_{0};
  std::uint64_t total_ = 0;
  std::chrono::steady_clock::time_point last_told_;
  std::atomic<bool> stopped_{false};
};

}  // namespace pellucid::c
