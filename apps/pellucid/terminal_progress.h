// One line on a terminal's stderr that tells what runs, how far it is, and how long it will take. Silent in a
// pipe.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "pellucid/base.h"

namespace pellucid::cli {

class TerminalProgress final : public Progress {
 public:
  // `wanted` false: neither the line nor notes.
  explicit TerminalProgress(bool wanted);
  ~TerminalProgress() override;

  void begin(std::string_view name, std::uint64_t total) override;
  void advance(std::uint64_t amount) override;
  void note(std::string_view line) override;
  [[nodiscard]] bool stop_requested() const override;

  // What stands before the stage: "3/12 bunny.ply: 1/2 body: occlusion graph".
  void set_file(const std::string& file);
  void set_subject(const std::string& subject);
  // Wipe the line until the next stage begins, so that other text can be written.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  // Steps may take long: the clock goes on while nothing advances.
  void keep_drawing();
  void draw();
  void wipe();

  const bool wanted_, visible_;
  std::mutex mutex_;  // of all that follows but the counts
  std::string file_, subject_, stage_;
  Clock::time_point started_;
  std::uint64_t total_ = 0;
  bool in_stage_ = false, on_screen_ = false, closing_ = false;
  std::atomic<std::uint64_t> done_{0};
  std::condition_variable closes_;
  std::thread drawer_;
};

// Ctrl-C and SIGTERM raise a flag that stop_requested() reads; a second one ends the process at once.
void install_stop_signals();
// Throws Error{interrupted} once the flag is up.
void stop_if_signalled();

}  // namespace pellucid::cli
