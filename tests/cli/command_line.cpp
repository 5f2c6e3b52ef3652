// Implements command_line.h: runs the real program.
#include "command_line.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

namespace pellucid::testing {
namespace {

pid_t start(const Arguments& arguments, const std::string& out, const std::string& err,
            rlim_t largest_file = RLIM_INFINITY) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  if (largest_file != RLIM_INFINITY) {
    // Writing beyond the limit fails, as on a full disk, instead of ending the program.
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{largest_file, largest_file};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  const int out_file = ::open(out.c_str(), O_WRONLY | O_CREAT, 0600);
  const int err_file = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
  ::dup2(out_file, STDOUT_FILENO);
  ::dup2(err_file, STDERR_FILENO);
  std::vector<char*> words;
  std::string program = PELLUCID_BINARY;
  std::vector<std::string> copies = arguments;
  words.push_back(program.data());
  for (std::string& argument : copies) words.push_back(argument.data());
  words.push_back(nullptr);
  ::execv(PELLUCID_BINARY, words.data());
  ::_exit(127);
}

Finished collect(int status, const std::string& out, const std::string& err) {
  Finished finished;
  finished.code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  if (std::filesystem::is_regular_file(out)) finished.out = slurp(out);
  finished.err = slurp(err);
  return finished;
}

Finished finish(pid_t child, const std::string& out, const std::string& err) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return collect(status, out, err);
}

}  // namespace

Finished run_pellucid(const Arguments& arguments, const std::string& stdout_to) {
  const TemporaryFolder folder;
  const std::string out = stdout_to.empty() ? folder.file("out") : stdout_to;
  const std::string err = folder.file("err");
  return finish(start(arguments, out, err), out, err);
}

Finished run_pellucid_on_full_disk(const Arguments& arguments, std::size_t bytes) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  const std::string err = folder.file("err");
  return finish(start(arguments, out, err, bytes), out, err);
}

Finished interrupt_pellucid(const Arguments& arguments, int signal, double ready_after) {
  const TemporaryFolder folder;
  const pid_t child = start(arguments, folder.file("out"), folder.file("err"));
  std::this_thread::sleep_for(std::chrono::duration<double>(ready_after));
  ::kill(child, signal);
  return finish(child, folder.file("out"), folder.file("err"));
}

Finished signal_pellucid_when(const Arguments& arguments, int signal, const std::function<bool()>& ready) {
  const TemporaryFolder folder;
  const pid_t child = start(arguments, folder.file("out"), folder.file("err"));
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (ready()) {
      ::kill(child, signal);
      return finish(child, folder.file("out"), folder.file("err"));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return collect(status, folder.file("out"), folder.file("err"));
}

bool has_terminals() {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (terminal >= 0) ::close(terminal);
  return terminal >= 0;
}

Finished run_on_terminal(const Arguments& arguments) {
  const TemporaryFolder folder;
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0) {
    throw std::runtime_error("no pseudo terminal");
  }
  const pid_t child = start(arguments, folder.file("out"), ::ptsname(terminal));
  std::string shown;
  char buffer[4096];
  // Reading fails once the child has closed its end.
  for (ssize_t got = 0; (got = ::read(terminal, buffer, sizeof(buffer))) > 0;) {
    shown.append(buffer, static_cast<std::size_t>(got));
  }
  Finished finished = finish(child, folder.file("out"), folder.file("err"));
  ::close(terminal);
  finished.err = shown;
  return finished;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "pellucid-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryFolder::files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

Arguments quick_order(const std::string& input, const std::string& output, const Arguments& more) {
  Arguments arguments{"order",       input, "-o",        output, "--partition",   "S0,1",
                      "--distances", "3",   "--buffers", "2",    "--check-views", "0"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

Samples::Samples() : plain(folder.file("goblet.glb")), ordered(folder.file("ordered.glb")) {
  const Finished sample = run_pellucid({"sample", "goblet", "-o", plain, "--detail", "0.02"});
  const Finished order = run_pellucid(quick_order(plain, ordered));
  problems = sample.err + order.err;
}

const Samples& samples() {
  static const Samples kMade;
  EXPECT_EQ(kMade.problems, "");
  return kMade;
}

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void spill(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

nlohmann::json parse_json_file(const std::string& path) {
  return nlohmann::json::parse(slurp(path), nullptr, false);
}

std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace pellucid::testing
