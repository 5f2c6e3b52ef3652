// Tests techniques with a memory budget from the command line.
#include <gtest/gtest.h>

#include <filesystem>

#include "command_line.h"
#include "report/schema.h"

namespace pellucid::testing {
namespace {

#if defined(PELLUCID_WITH_RENDERER)
TEST(BudgetOptions, RefuseValuesOutOfRange) {
  const TemporaryFolder folder;
  for (const Arguments& bad :
       {Arguments{"--device-memory", "5XB"}, Arguments{"--device-memory", "-1MB"},
        Arguments{"--device-memory", "0.5"}, Arguments{"--importance", "beauty"},
        Arguments{"--allocation", "fair"}, Arguments{"--focus", "1"}, Arguments{"--complexity", "2,25"},
        Arguments{"--falloff", "0"}, Arguments{"--falloff", "nan"}, Arguments{"--importance-noise", "nan"}}) {
    Arguments arguments{"render", samples().plain, "-o", folder.file("p.png"), "--technique", "variable-k"};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 2) << bad[0] << " " << bad[1] << ": " << done.err;
    EXPECT_NE(done.err.find(bad[0]), std::string::npos) << done.err;
  }
  EXPECT_TRUE(folder.files().empty());
}

Arguments render(const TemporaryFolder& folder, const Arguments& more) {
  Arguments arguments{"render", samples().plain, "-o",          folder.file("p.png"), "--validation-layers",
                      "--size", "96x64",         "--technique", "variable-k",         "--json",
                      "-"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(BudgetOptions, KeepWithinTheMemory) {
  const TemporaryFolder folder;
  for (const char* memory : {"64", "60KB", "100KiB"}) {
    const Finished done = run_pellucid(render(folder, {"--device-memory", memory}));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.err, "");
    const nlohmann::json json = nlohmann::json::parse(done.out);
    const std::uint64_t most = memory[0] == '1' ? 102'400 : memory[2] == 'K' ? 60'000 : 64;
    EXPECT_LE(json["bytes"], most);
    EXPECT_LE(json["k_least"], json["k_most"]);
  }
  EXPECT_EQ(run_pellucid(render(folder, {"--device-memory", "10"})).code, 2);
}

TEST(BudgetOptions, FormsDrawTheSame) {
  const TemporaryFolder folder;
  const auto drawn_by = [&](const Arguments& form) {
    Arguments more{"--device-memory", "60KB"};
    more.insert(more.end(), form.begin(), form.end());
    const Finished done = run_pellucid(render(folder, more));
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.err, "");
    return nlohmann::json::parse(done.out);
  };
  const nlohmann::json chain = drawn_by({});
  const nlohmann::json heap = drawn_by({"--sync", "spinlock", "--heap-from", "1"});
  EXPECT_EQ(heap["sync"], "spinlock");
  for (const char* key : {"captured", "overflowed", "k_least", "k_most", "bytes", "passes"})
    EXPECT_EQ(chain[key], heap[key]) << key;
  const Finished refused = run_pellucid(render(folder, {"--sync", "ordered"}));
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("variable-k has only"), std::string::npos) << refused.err;
}

// Every sample is a pixel of its own: bytes for all fragments hold all of them.
TEST(BudgetOptions, SweepsOfMemoryKnowOfSamples) {
  const Finished done =
      run_pellucid({"compare", samples().plain, "--techniques", "k-plus", "--sweep", "memory", "--samples",
                    "4", "--size", "48x32", "--frames", "1", "--validation-layers", "--json", "-"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  const nlohmann::json points = nlohmann::json::parse(done.out)["sweeps"][0]["points"];
  EXPECT_LT(points.front()["techniques"][0]["r_h"].get<double>(), 1);
  EXPECT_EQ(points.back()["techniques"][0]["r_h"], 1);
}

TEST(BudgetOptions, WriteMapsAndReadAnImportanceImage) {
  const TemporaryFolder folder;
  const std::string maps = folder.file("maps");
  ASSERT_EQ(run_pellucid(render(folder, {"--maps", maps})).code, 0);
  for (const char* name : {"importance", "k", "loss"})
    EXPECT_GT(slurp(maps + "/" + name + ".png").size(), 60U);
  const Finished done = run_pellucid(render(
      folder, {"--importance", "image", "--importance-image", maps + "/k.png", "--device-memory", "80KB"}));
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(run_pellucid(render(folder, {"--importance", "image"})).code, 2);
  EXPECT_EQ(
      run_pellucid(render(folder, {"--importance", "image", "--importance-image", samples().plain})).code, 3);
  EXPECT_EQ(run_pellucid({"render", samples().plain, "-o", folder.file("q.png"), "--maps", maps}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.file("q.png")));
}
#endif

}  // namespace
}  // namespace pellucid::testing
