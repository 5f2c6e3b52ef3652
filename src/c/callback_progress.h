// Internal to the C interface: the library's Progress as a C function.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

#include "pellucid/base.h"
#include "pellucid/c/pellucid.h"

namespace pellucid::c {

// Work reports from many threads, and often; the caller hears of it one call at a time, and now and then.
class CallbackProgress final : public Progress {
 public:
  explicit CallbackProgress(const PellucidRun& run) : run_(run) {}

  void begin(std::string_view name, std::uint64_t total) override;
  void advance(std::uint64_t amount) override;
  [[nodiscard]] bool stop_requested() const override { return stopped_; }

  // What the modules' options take: null where the caller does not want to hear.
  [[nodiscard]] Progress* pointer() { return run_.progress == nullptr ? nullptr : this; }

 private:
  void tell();  // with the lock held

  PellucidRun run_;
  std::mutex mutex_;
  std::string stage_;
  std::atomic<std::uint64_t> done_{0};
  std::uint64_t total_ = 0;
  std::chrono::steady_clock::time_point last_told_;
  std::atomic<bool> stopped_{false};
};

}  // namespace pellucid::c
