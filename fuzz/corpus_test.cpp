// Replays all files of the corpora, so that what fuzzing once found stays fixed.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "pellucid/base.h"
#include "readers.h"

namespace pellucid::fuzz {
namespace {

std::vector<std::string> files_of(const Target& target) {
  std::vector<std::string> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(PELLUCID_CORPUS "/" + std::string(target.name)))
    files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

class Corpus : public ::testing::TestWithParam<Target> {};

TEST_P(Corpus, IsReadOrRefused) {
  const std::vector<std::string> files = files_of(GetParam());
  EXPECT_FALSE(files.empty());
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    const std::vector<std::byte> bytes = read_file(file);
    GetParam().read({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  }
}

INSTANTIATE_TEST_SUITE_P(All, Corpus, ::testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace pellucid::fuzz
