// Tests `pellucid order --checkpoint`: runs that were killed or interrupted end with the same bytes as runs
// that were not.
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <set>

#include "command_line.h"

namespace pellucid::testing {
namespace {

namespace fs = std::filesystem;

Arguments joined(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Records are told apart by kind: "sequence-3.0a1b....record" is a "sequence".
std::set<std::string> record_kinds(const std::string& folder) {
  std::set<std::string> kinds;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".record")) kinds.insert(name.substr(0, name.find_first_of("0123456789.")));
  }
  return kinds;
}

std::vector<std::string> other_files(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".record") && name != ".lock") names.push_back(name);
  }
  return names;
}

struct Knot {
  Knot() : path(folder.file("knot.glb")) {
    problems = run_pellucid({"sample", "torus-knot", "-o", path, "--detail", "0.03"}).err;
  }
  TemporaryFolder folder;
  std::string path, problems;
};
const std::string& knot() {
  static const Knot kMade;
  EXPECT_EQ(kMade.problems, "");
  return kMade.path;
}

const Arguments kBudget{"--partition", "S0,0", "--distances", "3", "--buffers", "2", "--check-views", "2"};
const Arguments kAcyclic{"--partition", "S0,0", "--distances",   "3", "--method", "acyclic",
                         "--tolerance", "0.01", "--check-views", "2"};
const Arguments kUpsampled{"--partition",     "S0,0", "--distances", "3", "--buffers",     "2",
                           "--upsample-from", "150",  "--refine",    "2", "--check-views", "2"};

TEST(LongRuns, KilledRunsContinueToTheSameBytes) {
  for (const Arguments& options : {kAcyclic, kUpsampled}) {
    SCOPED_TRACE(options[5]);
    const TemporaryFolder folder;
    const std::string expected = folder.file("expected.glb");
    const std::string out = folder.file("out.glb");
    const std::string records = folder.file("records");
    ASSERT_EQ(run_pellucid(joined({"order", knot(), "-o", expected}, options)).code, 0);
    const Arguments command = joined({"order", knot(), "-o", out, "--checkpoint", records}, options);
    std::set<std::string> seen;
    std::uint32_t kills = 0;
    for (;; ++kills) {
      ASSERT_LT(kills, 30U);
      const Finished done = signal_pellucid_when(command, SIGKILL, [&] {
        const std::set<std::string> kinds = record_kinds(records);
        return !std::includes(seen.begin(), seen.end(), kinds.begin(), kinds.end());
      });
      if (done.code == 0) break;
      ASSERT_EQ(done.code, 1000 + SIGKILL) << done.err;
      EXPECT_FALSE(fs::exists(out));
      seen.merge(record_kinds(records));
    }
    EXPECT_GT(kills, 2U);
    EXPECT_TRUE(slurp(out) == slurp(expected));
    EXPECT_FALSE(fs::exists(records));
  }
}

// Leaves some records of a run that was killed.
void leave_records(const Arguments& command, const std::string& records, const std::string& kind) {
  const Finished done =
      signal_pellucid_when(command, SIGKILL, [&] { return record_kinds(records).contains(kind); });
  ASSERT_EQ(done.code, 1000 + SIGKILL) << done.err;
}

TEST(LongRuns, RecordsServeTheirOwnOptionsAndAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const std::string records = folder.file("records");
  const std::string out = folder.file("out.glb");
  const auto command = [&](const Arguments& more) {
    return joined(joined({"order", knot(), "-o", out, "--checkpoint", records}, kBudget), more);
  };
  leave_records(command({"--threads", "2"}), records, "sequence-");

  const std::string expected = folder.file("expected.glb");
  ASSERT_EQ(run_pellucid(joined(joined({"order", knot(), "-o", expected}, kBudget), {"--seed", "7"})).code,
            0);
  const Finished other = run_pellucid(command({"--seed", "7"}));
  ASSERT_EQ(other.code, 0) << other.err;
  EXPECT_NE(other.err.find("of another mesh, other options or another version"), std::string::npos)
      << other.err;
  EXPECT_EQ(count_lines(other.err), 1U) << other.err;
  EXPECT_TRUE(slurp(out) == slurp(expected));
  EXPECT_TRUE(record_kinds(records).contains("sequence-"));  // of the run that was killed: left alone

  ASSERT_EQ(run_pellucid(joined({"order", knot(), "-o", expected}, kBudget)).code, 0);
  const Finished same = run_pellucid(command({"--threads", "1"}));
  ASSERT_EQ(same.code, 0) << same.err;
  EXPECT_NE(same.err.find("continuing from"), std::string::npos) << same.err;
  EXPECT_TRUE(slurp(out) == slurp(expected));
  EXPECT_FALSE(fs::exists(records));
}

TEST(LongRuns, ADamagedRecordIsReportedInOneLineAndComputedAgain) {
  const TemporaryFolder folder;
  const std::string records = folder.file("records");
  const std::string out = folder.file("out.glb");
  const std::string expected = folder.file("expected.glb");
  const Arguments command = joined({"order", knot(), "-o", out, "--checkpoint", records}, kBudget);
  ASSERT_EQ(run_pellucid(joined({"order", knot(), "-o", expected}, kBudget)).code, 0);
  leave_records(command, records, "sequence-");
  std::string damaged;
  for (const auto& entry : fs::directory_iterator(records)) {
    if (!entry.path().filename().string().starts_with("sequence-")) continue;
    damaged = entry.path().string();
    fs::resize_file(entry.path(), fs::file_size(entry.path()) - 100);
    break;
  }
  const Finished done = run_pellucid(command);
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.err.find(damaged + ": a truncated record: computed anew"), std::string::npos) << done.err;
  EXPECT_EQ(count_lines(done.err), 2U) << done.err;  // and that it continues
  EXPECT_TRUE(slurp(out) == slurp(expected));
}

TEST(LongRuns, AFolderThatCannotBeWrittenIsReportedInOneLine) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out.glb");
  const std::string file = folder.file("file");
  spill(file, "not a folder");
  for (const std::string& bad : {file, folder.file("no/such/folder"), std::string("/proc/records")}) {
    const Finished done = run_pellucid(quick_order(knot(), out, {"--checkpoint", bad}));
    EXPECT_EQ(done.code, 1) << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
    EXPECT_NE(done.err.find(bad), std::string::npos) << done.err;
    EXPECT_FALSE(fs::exists(out));
  }
}

// Records, the model, the frontier and --memory's temporary file, each on a disk that is full.
TEST(LongRuns, AFullDiskIsReportedInOneLineAndLeavesNoFiles) {
  const Arguments order = joined({"order", knot()}, kBudget);
  struct Case {
    Arguments more;  // file names: in a folder of their own
    std::size_t bytes;
    std::string named;
  };
  const std::vector<Case> cases{{{"-o", "out.glb", "--checkpoint", "records"}, 8192, "records"},
                                {{"-o", "out.glb"}, 4096, "out.glb"},
                                {{"--frontier", "curve.svg", "--max-buffers", "2"}, 512, "curve.svg"},
                                {{"-o", "out.glb", "--memory", "1MB"}, 8192, "temporary file"}};
  for (const Case& full : cases) {
    SCOPED_TRACE(full.named);
    const TemporaryFolder folder;
    Arguments command = order;
    if (full.more[0] == "--frontier") command.resize(command.size() - 4);  // takes no --buffers
    for (const std::string& word : full.more) {
      const bool name = word.find('.') != std::string::npos || word == "records";
      command.push_back(name ? folder.file(word) : word);
    }
    const Finished done = run_pellucid_on_full_disk(command, full.bytes);
    EXPECT_EQ(done.code, 1) << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
    EXPECT_NE(done.err.find(full.named), std::string::npos) << done.err;
    EXPECT_NE(done.err.find("cannot write"), std::string::npos) << done.err;
    EXPECT_TRUE(folder.files().empty());
  }
}

TEST(LongRuns, ATerminalSeesEveryStage) {
  if (!has_terminals()) GTEST_SKIP() << "this system has no pseudo terminals";
  const TemporaryFolder folder;
  const auto expect_stages = [](const Arguments& command, const std::vector<std::string>& stages) {
    const Finished done = run_on_terminal(command);
    ASSERT_EQ(done.code, 0) << done.err;
    std::size_t at = 0;
    for (const std::string& stage : stages) {
      at = done.err.find(stage, at);
      ASSERT_NE(at, std::string::npos) << stage << " in\n" << done.err;
    }
    // Nothing of it is left when the results come.
    EXPECT_TRUE(done.err.ends_with("\r\033[K")) << done.err;
    EXPECT_EQ(done.err.find('\n'), std::string::npos) << done.err;
  };
  const Arguments one{"order", knot(), "-o", folder.file("out.glb")};
  expect_stages(joined(one, kBudget), {"reading", "occlusion graph  [", "trying 2 orders", "sequences  [",
                                       "base order", "measure  [", "writing"});
  expect_stages(joined(one, kAcyclic),
                {"occlusion graph  [", "cells  [", "merging  [", "relaxation", "sequences  ["});
  expect_stages(joined(one, kUpsampled),
                {"occlusion graph  [", "refinement  [", "wrong pixels", "sequences  ["});
  // Several files say which one is at work.
  const Arguments two = quick_order(knot(), folder.file("many/"), {samples().plain});
  expect_stages(two, {"1/2 knot.glb: ", "2/2 goblet.glb: "});
  EXPECT_EQ(run_on_terminal(joined(two, {"--quiet"})).err, "");
}

// Ctrl-C at each of the steps that leave a record.
TEST(LongRuns, InterruptedInAnyStage) {
  const TemporaryFolder folder;
  const std::string records = folder.file("records");
  const Arguments command =
      joined({"order", knot(), "-o", folder.file("out.glb"), "--checkpoint", records}, kUpsampled);
  std::set<std::string> seen;
  for (;;) {
    const Finished done = signal_pellucid_when(command, SIGINT, [&] {
      const std::set<std::string> kinds = record_kinds(records);
      return !std::includes(seen.begin(), seen.end(), kinds.begin(), kinds.end());
    });
    if (done.code == 0) break;
    ASSERT_EQ(done.code, 130) << done.err;
    const std::string last = "interrupted: the same command continues from the records in " + records + "\n";
    EXPECT_TRUE(done.err.ends_with(last)) << done.err;
    EXPECT_TRUE(other_files(records).empty());
    EXPECT_EQ(folder.files(), std::vector<std::string>{"records"});
    const std::size_t before = seen.size();
    seen.merge(record_kinds(records));
    ASSERT_GT(seen.size(), before);
  }
  EXPECT_GT(seen.size(), 2U);
  EXPECT_EQ(folder.files(), std::vector<std::string>{"out.glb"});
}

}  // namespace
}  // namespace pellucid::testing
