// One line on a terminal's stderr that tells what runs, how far it is, and how long it will take. Silent in a
// pipe.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

#include "pellucid/base.h"

namespace pellucid::cli {

class TerminalProgress final : public Progress {
 public:
  explicit TerminalProgress(bool wanted);
  ~TerminalProgress() override;

  void begin(std::string_view name, std::uint64_t total) override;
  void advance(std::uint64_t amount) override;
  [[nodiscard]] bool stop_requested() const override;

  void set_subject(const std::string& subject);
  // Wipe the line, so that other text can be written.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void draw(Clock::time_point now);

  const bool visible_;
  std::mutex mutex_;
  std::string subject_;
  std::string stage_;
  Clock::time_point started_;
  Clock::time_point drawn_;
  bool on_screen_ = false;
  std::atomic<std::uint64_t> total_{0};
  std::atomic<std::uint64_t> done_{0};
};

// Ctrl-C and SIGTERM raise a flag that stop_requested() reads; a second one ends the process at once.
void install_stop_signals();
// Throws Error{interrupted} once the flag is up.
void stop_if_signalled();

}  // namespace pellucid::cli
