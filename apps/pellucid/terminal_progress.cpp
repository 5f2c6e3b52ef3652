// The progress line and the stop flag: see terminal_progress.h.
#include "terminal_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/platform/platform.h"

namespace pellucid::cli {
namespace {

constexpr std::chrono::milliseconds kRedrawEvery{100};
constexpr int kBarCells = 24;

std::atomic<bool> stop_flag{false};

std::string clock_text(double seconds) {
  const auto whole = std::llround(std::max(0.0, seconds));
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string rate_text(double per_second) {
  return fmt::format("{:.{}f}/s", per_second, per_second < 10 ? 1 : 0);
}

}  // namespace

TerminalProgress::TerminalProgress(bool wanted)
    : wanted_(wanted), visible_(wanted && platform::stderr_is_terminal()) {
  if (visible_) drawer_ = std::thread([this] { keep_drawing(); });
}

TerminalProgress::~TerminalProgress() {
  clear();
  if (!drawer_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  closes_.notify_one();
  drawer_.join();
}

void TerminalProgress::begin(std::string_view name, std::uint64_t total) {
  if (!visible_) return;
  const std::lock_guard lock(mutex_);
  stage_ = name;
  started_ = Clock::now();
  total_ = total;
  done_ = 0;
  in_stage_ = true;
  draw();
}

void TerminalProgress::advance(std::uint64_t amount) {
  done_ += amount;
}

void TerminalProgress::note(std::string_view line) {
  if (!wanted_) return;
  const std::lock_guard lock(mutex_);
  wipe();
  const std::string text = fmt::format("pellucid: note: {}\n", line);
  std::fputs(text.c_str(), stderr);
}

bool TerminalProgress::stop_requested() const {
  return stop_flag;
}

void TerminalProgress::set_file(const std::string& file) {
  const std::lock_guard lock(mutex_);
  file_ = file.empty() ? "" : file + ": ";
}

void TerminalProgress::set_subject(const std::string& subject) {
  const std::lock_guard lock(mutex_);
  subject_ = subject.empty() ? "" : subject + ": ";
}

void TerminalProgress::clear() {
  const std::lock_guard lock(mutex_);
  wipe();
  in_stage_ = false;
}

void TerminalProgress::wipe() {
  if (on_screen_) std::fputs("\r\033[K", stderr);
  on_screen_ = false;
}

void TerminalProgress::keep_drawing() {
  std::unique_lock lock(mutex_);
  while (!closes_.wait_for(lock, kRedrawEvery, [this] { return closing_; })) {
    if (in_stage_) draw();
  }
}

void TerminalProgress::draw() {
  on_screen_ = true;
  const double seconds = std::chrono::duration<double>(Clock::now() - started_).count();
  const auto done = static_cast<double>(done_);
  std::string line = "\r\033[K" + file_ + subject_ + stage_;
  if (total_ > 0) {
    const double share = std::min(1.0, done / static_cast<double>(total_));
    const auto filled = static_cast<std::size_t>(share * kBarCells);
    line += fmt::format("  [{}{}] {:3.0f} %", std::string(filled, '='), std::string(kBarCells - filled, ' '),
                        100 * share);
    if (seconds > 0.5 && share > 0) {
      line += fmt::format("  {}, {} left", rate_text(done / seconds), clock_text(seconds / share - seconds));
    } else if (seconds > 0.5) {
      line += "  " + clock_text(seconds);
    }
  } else if (seconds > 0.5) {
    // How much there is to do shows only when it is done.
    line += "  " + clock_text(seconds);
    if (done > 0) line += fmt::format(", {:.0f} done, {}", done, rate_text(done / seconds));
  }
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

void install_stop_signals() {
  platform::set_on_stop_signal(stop_flag);
}

void stop_if_signalled() {
  if (stop_flag) throw Error(ErrorKind::interrupted, "interrupted");
}

}  // namespace pellucid::cli
