// Runs the real program as another program would. In: arguments. Out: its exit code and output.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pellucid::testing {

using Arguments = std::vector<std::string>;

struct Finished {
  int code = -1;  // exit code, or 1000 + signal
  std::string out, err;
};

// stdout and stderr go to files, as in a pipeline: nothing is a terminal. `stdout_to`: another file for
// stdout.
Finished run_pellucid(const Arguments& arguments, const std::string& stdout_to = "");

// On a disk that takes no more than `bytes` of a file.
Finished run_pellucid_on_full_disk(const Arguments& arguments, std::size_t bytes);

// Start, send `signal` once `ready_after` seconds have passed, wait.
Finished interrupt_pellucid(const Arguments& arguments, int signal, double ready_after);

// Start, send `signal` as soon as `ready` says so, wait. It may finish before.
Finished signal_pellucid_when(const Arguments& arguments, int signal, const std::function<bool()>& ready);

// Whether the system has pseudo terminals, which a container without /dev/pts does not.
bool has_terminals();

// stderr is a terminal: `err` is all that was drawn on it.
Finished run_on_terminal(const Arguments& arguments);

// An empty folder that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::vector<std::string> files() const;

 private:
  std::filesystem::path path_;
};

// Files that many tests read, made once: a small scene, ordered quickly.
struct Samples {
  Samples();
  TemporaryFolder folder;
  std::string plain;     // a coarse goblet as .glb
  std::string ordered;   // the same with orders
  std::string problems;  // what stderr said while they were made
};
const Samples& samples();

// A quick `order`: few cells, two buffers, no validation.
Arguments quick_order(const std::string& input, const std::string& output, const Arguments& more = {});

std::string slurp(const std::string& path);
void spill(const std::string& path, const std::string& text);
nlohmann::json parse_json_file(const std::string& path);
std::size_t count_lines(const std::string& text);

}  // namespace pellucid::testing
