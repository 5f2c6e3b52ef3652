// Implements session.h: what the subcommands share.
#include "session.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <string_view>
#include <thread>

#include "base/platform/platform.h"

namespace pellucid::cli {

// -------------------------------------------------------------------------------------------------- progress

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

// Shows progress as one line on stderr if that is a terminal: what runs, how far it is, and how long it will
// take. It shows nothing in a pipe.
class TerminalProgress final : public Progress {
 public:
  // Without `wanted` neither the line nor notes are printed.
  explicit TerminalProgress(bool wanted);
  ~TerminalProgress() override;

  void begin(std::string_view name, std::uint64_t total) override;
  void advance(std::uint64_t amount) override;
  void note(std::string_view line) override;
  [[nodiscard]] bool stop_requested() const override;

  // Set the text before the stage: "3/12 bunny.ply: 1/2 body: occlusion graph".
  void set_file(const std::string& file);
  void set_subject(const std::string& subject);
  // Clears the line until the next stage begins, so that other text can be written.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  // Redraws the line periodically, so that the clock runs during long steps.
  void keep_drawing();
  void draw();
  void wipe();

  const bool wanted_, visible_;
  std::mutex mutex_;  // guards the members below, except the atomic one
  std::string file_, subject_, stage_;
  Clock::time_point started_;
  std::uint64_t total_ = 0;
  bool in_stage_ = false, on_screen_ = false, closing_ = false;
  std::atomic<std::uint64_t> done_{0};
  std::condition_variable closes_;
  std::thread drawer_;
};

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
    // The amount of work is not known in advance.
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

// --------------------------------------------------------------------------------------------------- session

namespace {

void write_stdout(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Error(ErrorKind::cannot_write,
                std::string("standard output: cannot write: ") + std::strerror(errno));
  }
}

}  // namespace

Session::Session(CommonOptions options)
    : options_(std::move(options)), progress_(std::make_unique<TerminalProgress>(!options_.quiet)) {}

Session::~Session() = default;

Progress* Session::progress() const {
  return progress_.get();
}

void Session::set_subject(const std::string& subject) {
  progress_->set_subject(subject);
}

void Session::set_file(const std::string& file) {
  progress_->set_file(file);
}

void Session::print(const std::string& text) const {
  progress_->clear();
  if (options_.json != "-" && !options_.quiet) write_stdout(text);
}

void Session::note(const std::string& line) const {
  progress_->note(line);
}

void Session::complain(const std::string& message) const {
  progress_->clear();
  cli::complain(message);
}

void complain(const std::string& message) {
  // File names may contain line breaks; the message stays on one line.
  std::string line = message;
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::fprintf(stderr, "pellucid: %s\n", line.c_str());
}

void Session::detail(const std::string& line) const {
  if (!options_.verbose) return;
  progress_->clear();
  std::fprintf(stderr, "pellucid: %s\n", line.c_str());
}

bool Session::is_first_mention(const std::string& path) const {
  return mentioned_.insert(path).second;
}

void Session::check_json() const {
  if (!options_.json.empty() && options_.json != "-") check_writable(options_.json);
}

void Session::write_json(const std::string& json) const {
  progress_->clear();
  if (options_.json.empty()) return;
  if (options_.json == "-") {
    write_stdout(json);
  } else {
    write_file_atomically(options_.json, json);
  }
}

void check_writable(const std::string& path) {
  const auto refuse = [&](const std::string& reason) {
    throw Error(ErrorKind::cannot_write, path + ": cannot write: " + reason);
  };
  const auto refuse_unless_writable = [&](const std::string& target) {
    if (const std::error_code refusal = platform::write_refusal(target)) refuse(refusal.message());
  };
  const std::string parent = platform::to_utf8(platform::to_path(path).parent_path());
  const std::string folder = parent.empty() ? "." : parent;
  if (platform::file_kind(folder) != platform::FileKind::folder) refuse("there is no folder " + folder);
  const platform::FileKind kind = platform::file_kind(path);
  if (kind == platform::FileKind::folder) refuse("it is a directory");
  // A device is written directly. A file is replaced by another one that is created in its folder.
  if (kind != platform::FileKind::missing) refuse_unless_writable(path);
  if (kind != platform::FileKind::device) refuse_unless_writable(folder);
}

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::bad_argument:
      return 2;
    case ErrorKind::bad_input:
      return 3;
    case ErrorKind::nothing_to_do:
      return 4;
    case ErrorKind::quality_missed:
      return 5;
    case ErrorKind::interrupted:
      return 130;
    case ErrorKind::cannot_write:
    case ErrorKind::internal:
      break;
  }
  return 1;
}

const char* const kOutOfMemory =
    "out of memory: try a smaller mesh (--simplify), fewer view cells (--partition S1,2) or a smaller image "
    "(--size)";

void check_extensions(const Model& model, const Session& session) {
  if (model.unknown_required.empty()) return;
  std::string names;
  for (const std::string& name : model.unknown_required) names += (names.empty() ? "" : ", ") + name;
  const std::string reason = model.path + ": it requires " + names + ", which pellucid does not understand";
  if (session.options().strict) throw Error(ErrorKind::bad_input, reason + " (--strict)");
  session.note(reason + "; it is read as if that were not there");
}

Model open_model(const std::string& path, const Session& session) {
  Model model = read_model(path);
  // A command may read a file twice.
  if (!session.is_first_mention(path)) return model;
  check_extensions(model, session);
  for (const std::string& note : model.notes) {
    // The notes on a glTF say what is kept in the file that is written.
    is_gltf(model) ? session.detail(path + ": " + note) : session.note(path + ": " + note);
  }
  return model;
}

CLI::App* add_command(CLI::App& app, Chosen& chosen, const std::string& name, const std::string& description,
                      const std::string& examples, std::uint64_t default_seed, Work work, Reads reads) {
  CLI::App* command = app.add_subcommand(name, description);
  auto options = std::make_shared<CommonOptions>();
  options->seed = default_seed;
  command->get_help_ptr()->group(kCommonGroup);
  command
      ->add_option("--json", options->json,
                   "Write statistics as JSON to FILE; \"-\": to stdout, instead of the table")
      ->type_name("FILE")
      ->group(kCommonGroup);
  command
      ->add_option("--threads", options->threads, "Use at most N threads; 0: all cores. Results never change")
      ->type_name("N")
      ->capture_default_str()
      ->group(kCommonGroup);
  command->add_option("--seed", options->seed, "Seed of all random numbers")
      ->type_name("N")
      ->capture_default_str()
      ->group(kCommonGroup);
  if (reads == Reads::models) {
    command
        ->add_flag("--strict", options->strict,
                   "Refuse files that are understood only in part, and broken triangles, instead of a note")
        ->group(kCommonGroup);
  }
  command->add_flag("-q,--quiet", options->quiet, "Print errors only")->group(kCommonGroup);
  command->add_flag("-v,--verbose", options->verbose, "Print more details to stderr")->group(kCommonGroup);
  command->footer("Examples:\n" + examples);
  command->callback([&chosen, options, work = std::move(work)] {
    chosen.options = *options;
    chosen.work = work;
  });
  return command;
}

}  // namespace pellucid::cli
