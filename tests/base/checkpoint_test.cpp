// Tests CheckpointStore: records are loaded again, damaged ones are rejected, and all are removed at the end.
#include "pellucid/checkpoint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "temporary_folder.h"

namespace pellucid {
namespace {

namespace fs = std::filesystem;
using testing::slurp;
using testing::spill;

const std::string kRun(32, 'a');
const std::string kOtherRun(32, 'b');

class Notes final : public Progress {
 public:
  void begin(std::string_view /*name*/, std::uint64_t /*total*/) override {}
  void advance(std::uint64_t /*amount*/) override {}
  void note(std::string_view line) override { lines.emplace_back(line); }
  std::vector<std::string> lines;
};

class CheckpointFolder : public ::testing::Test {
 protected:
  [[nodiscard]] std::string record(const std::string& name, const std::string& run = kRun) const {
    return folder_ + "/" + name + "." + run + ".record";
  }

  const testing::TemporaryFolder parent_;
  const std::string folder_ = parent_.path("records");
  Notes notes_;
};

std::vector<std::byte> some_bytes(std::size_t size) {
  Random random(size);
  std::vector<std::byte> bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.next());
  return bytes;
}

TEST_F(CheckpointFolder, LoadsWhatWasSaved) {
  for (const std::size_t size : {0U, 1U, 31U, 32U, 33U, 100000U}) {
    const std::vector<std::byte> bytes = some_bytes(size);
    {
      CheckpointStore store(folder_, &notes_);
      store.begin_run(kRun);
      EXPECT_FALSE(store.load(kRun, "part-0"));
      store.save(kRun, "part-0", bytes);
    }
    CheckpointStore again(folder_, &notes_);
    again.begin_run(kRun);
    EXPECT_EQ(again.load(kRun, "part-0"), bytes);
    EXPECT_FALSE(again.load(kRun, "part-1"));
    EXPECT_FALSE(again.load(kOtherRun, "part-0"));
    ASSERT_EQ(notes_.lines.size(), 1U);
    EXPECT_NE(notes_.lines[0].find("continuing from 1 record"), std::string::npos) << notes_.lines[0];
    again.finish();
    EXPECT_FALSE(fs::exists(folder_));
    notes_.lines.clear();
  }
}

TEST_F(CheckpointFolder, RejectsDamagedRecords) {
  CheckpointStore store(folder_, &notes_);
  store.save(kRun, "part", some_bytes(1000));
  const std::string sound = slurp(record("part"));
  std::vector<std::string> damaged{
      "",          sound.substr(0, 10), sound.substr(0, 500), sound.substr(0, sound.size() - 1),
      sound + "x", sound.substr(1)};
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    std::string flipped = sound;
    char& byte = flipped[random.below(flipped.size())];
    byte = static_cast<char>(byte ^ (1 << random.below(8)));
    damaged.push_back(flipped);
  }
  for (const std::string& text : damaged) {
    notes_.lines.clear();
    spill(record("part"), text);
    EXPECT_FALSE(store.load(kRun, "part"));
    ASSERT_EQ(notes_.lines.size(), 1U);
    EXPECT_NE(notes_.lines[0].find(record("part")), std::string::npos) << notes_.lines[0];
    EXPECT_NE(notes_.lines[0].find("computed anew"), std::string::npos) << notes_.lines[0];
  }
  spill(record("part"), sound);
  EXPECT_EQ(store.load(kRun, "part"), some_bytes(1000));
  // A record of another part or another run that was renamed to this name.
  fs::copy_file(record("part"), record("other"));
  EXPECT_FALSE(store.load(kRun, "other"));
  fs::copy_file(record("part"), record("part", kOtherRun));
  EXPECT_FALSE(store.load(kOtherRun, "part"));
}

TEST_F(CheckpointFolder, IgnoresAndReportsRecordsOfOtherRuns) {
  {
    CheckpointStore store(folder_, &notes_);
    store.begin_run(kOtherRun);
    store.save(kOtherRun, "part", some_bytes(10));
    store.save(kOtherRun, "part-2", some_bytes(10));
  }
  CheckpointStore store(folder_, &notes_);
  store.begin_run(kRun);
  ASSERT_EQ(notes_.lines.size(), 1U);
  EXPECT_NE(notes_.lines[0].find("2 record(s) of another mesh"), std::string::npos) << notes_.lines[0];
  EXPECT_FALSE(store.load(kRun, "part"));
  store.save(kRun, "part", some_bytes(20));
  store.finish();
  EXPECT_TRUE(fs::exists(record("part", kOtherRun)));  // belongs to another run
  EXPECT_FALSE(fs::exists(record("part")));

  // Runs of several meshes may share one folder.
  notes_.lines.clear();
  CheckpointStore both(folder_ + "-2", &notes_);
  both.begin_run(kRun);
  both.save(kRun, "part", some_bytes(10));
  both.begin_run(kOtherRun);
  EXPECT_TRUE(notes_.lines.empty());
}

TEST_F(CheckpointFolder, RemovesReplacedRecords) {
  CheckpointStore store(folder_, &notes_);
  for (const char* name : {"a", "b", "result"}) store.save(kRun, name, some_bytes(10));
  store.save(kOtherRun, "a", some_bytes(10));
  store.remove_others(kRun, "result");
  EXPECT_FALSE(fs::exists(record("a")));
  EXPECT_FALSE(fs::exists(record("b")));
  EXPECT_TRUE(store.load(kRun, "result"));
  EXPECT_TRUE(store.load(kOtherRun, "a"));
}

TEST_F(CheckpointFolder, RemovesPartialFilesOfAKilledProcess) {
  fs::create_directory(folder_);
  spill(record("part") + ".aB3dE9", "half a rec");
  spill(folder_ + "/notes.txt", "of somebody else");
  CheckpointStore store(folder_, &notes_);
  EXPECT_FALSE(fs::exists(record("part") + ".aB3dE9"));
  store.begin_run(kRun);
  store.finish();
  EXPECT_TRUE(fs::exists(folder_ + "/notes.txt"));
}

TEST_F(CheckpointFolder, IsLockedByOneProcess) {
  const CheckpointStore store(folder_, &notes_);
  try {
    const CheckpointStore second(folder_, &notes_);
    FAIL() << "two stores share a folder";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::cannot_write);
    EXPECT_NE(std::string(error.what()).find(folder_), std::string::npos);
  }
}

TEST_F(CheckpointFolder, ReportsThePathThatCannotBeWritten) {
  const auto expect_refusal = [](const std::string& bad) {
    try {
      const CheckpointStore store(bad);
      FAIL() << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::cannot_write);
      EXPECT_NE(std::string(error.what()).find(bad), std::string::npos) << error.what();
    }
  };
  expect_refusal(folder_ + "/missing/parent");
  spill(folder_, "a file");
  expect_refusal(folder_);
}

TEST(HashBytes, DependsOnEveryBit) {
  const std::vector<std::byte> bytes = some_bytes(70);
  std::vector<std::uint64_t> hashes{hash_bytes(bytes, 1), hash_bytes(bytes, 2)};
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::vector<std::byte> changed = bytes;
    changed[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    hashes.push_back(hash_bytes(changed, 1));
  }
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    hashes.push_back(hash_bytes(std::span(bytes).first(size), 1));
    hashes.push_back(hash_bytes(std::vector<std::byte>(size), 1));  // the number of zeros counts, too
  }
  hashes.erase(std::find(hashes.begin(), hashes.end(), hash_bytes({}, 1)));  // the list has it twice
  std::sort(hashes.begin(), hashes.end());
  EXPECT_EQ(std::adjacent_find(hashes.begin(), hashes.end()), hashes.end());
}

}  // namespace
}  // namespace pellucid
