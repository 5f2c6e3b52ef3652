// What the subcommands share: see session.h.
#include "session.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/platform/platform.h"
#include "terminal_progress.h"

namespace pellucid::cli {
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

void Session::set_subject(const std::string& subject) {
  static_cast<TerminalProgress&>(*progress_).set_subject(subject);
}

void Session::set_file(const std::string& file) {
  static_cast<TerminalProgress&>(*progress_).set_file(file);
}

void Session::print(const std::string& text) const {
  static_cast<TerminalProgress&>(*progress_).clear();
  if (options_.json != "-" && !options_.quiet) write_stdout(text);
}

void Session::note(const std::string& line) const {
  progress_->note(line);
}

void Session::complain(const std::string& message) const {
  static_cast<TerminalProgress&>(*progress_).clear();
  cli::complain(message);
}

void complain(const std::string& message) {
  // One line, whatever a file name holds.
  std::string line = message;
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::fprintf(stderr, "pellucid: %s\n", line.c_str());
}

void Session::detail(const std::string& line) const {
  if (!options_.verbose) return;
  static_cast<TerminalProgress&>(*progress_).clear();
  std::fprintf(stderr, "pellucid: %s\n", line.c_str());
}

void Session::check_json() const {
  if (!options_.json.empty() && options_.json != "-") check_writable(options_.json);
}

void Session::write_json(const std::string& json) const {
  static_cast<TerminalProgress&>(*progress_).clear();
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
  // A device is written into, a file is replaced: by another that is made in its folder.
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
    "out of memory: try a smaller mesh (--simplify), fewer view cells (--views S1,2) or a smaller picture "
    "(--size)";

CLI::App* add_command(CLI::App& app, Chosen& chosen, const std::string& name, const std::string& description,
                      const std::string& examples, std::uint64_t default_seed, Work work) {
  CLI::App* command = app.add_subcommand(name, description);
  auto options = std::make_shared<CommonOptions>();
  options->seed = default_seed;
  command->add_option("--json", options->json, "Write statistics as JSON to FILE (\"-\": stdout, no table)")
      ->type_name("FILE")
      ->group("Common");
  command
      ->add_option("--threads", options->threads,
                   "Use at most N threads (0: all cores); never changes results")
      ->type_name("N")
      ->group("Common");
  command->add_option("--seed", options->seed, "Seed of everything random")
      ->type_name("N")
      ->capture_default_str()
      ->group("Common");
  command->add_flag("-q,--quiet", options->quiet, "Errors only")->group("Common");
  command->add_flag("-v,--verbose", options->verbose, "Tell more on stderr")->group("Common");
  command->footer("Examples:\n" + examples);
  command->callback([&chosen, options, work = std::move(work)] {
    chosen.options = *options;
    chosen.work = work;
  });
  return command;
}

}  // namespace pellucid::cli
