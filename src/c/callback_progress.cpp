// See callback_progress.h.
#include "c/callback_progress.h"

namespace pellucid::c {
namespace {

constexpr std::chrono::milliseconds kInterval{20};

}  // namespace

void CallbackProgress::begin(std::string_view name, std::uint64_t total) {
  const std::lock_guard lock(mutex_);
  stage_ = name;
  done_ = 0;
  total_ = total;
  tell();
}

void CallbackProgress::advance(std::uint64_t amount) {
  done_ += amount;
  // Whoever finds the lock taken leaves the telling to the one who holds it.
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && std::chrono::steady_clock::now() - last_told_ >= kInterval) tell();
}

void CallbackProgress::tell() {
  if (stopped_) return;
  if (run_.progress(run_.user, stage_.c_str(), done_, total_) != 0) stopped_ = true;
  last_told_ = std::chrono::steady_clock::now();
}

}  // namespace pellucid::c
