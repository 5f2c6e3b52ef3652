// Tests --deep and --pixel, which write all fragments of an image.
#include <gtest/gtest.h>

#include <cstdlib>

#include "command_line.h"

namespace pellucid::testing {
namespace {

Arguments render(const TemporaryFolder& folder, const std::string& technique, const Arguments& more) {
  Arguments arguments{
      "render",  samples().plain, "-o", folder.file("p.png"), "--size", "64x48", "--technique",
      technique, "--json",        "-"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(DeepPixels, RefuseWhatCannotBe) {
  const TemporaryFolder folder;
  for (const Arguments& bad :
       {Arguments{"--pixel", "64,0"}, Arguments{"--pixel", "3"}, Arguments{"--pixel", "1,2,3"},
        Arguments{"--pixel", "-1,2"}, Arguments{"--pixel", "4294967296,0"}}) {
    const Finished done = run_pellucid(render(folder, "cpu", bad));
    EXPECT_EQ(done.code, 2) << bad[1];
    EXPECT_NE(done.err.find("--pixel"), std::string::npos) << done.err;
  }
#ifdef PELLUCID_WITH_OPENEXR
  EXPECT_EQ(run_pellucid(render(folder, "cpu", {"--deep", folder.file("no/where.exr")})).code, 1);
#endif
  EXPECT_TRUE(folder.files().empty());
}

#ifndef PELLUCID_WITH_OPENEXR
TEST(DeepPixels, AreRefusedAsAFileInABuildWithoutOpenExr) {
  const TemporaryFolder folder;
  const Finished done = run_pellucid(render(folder, "cpu", {"--deep", folder.file("d.exr")}));
  EXPECT_EQ(done.code, 2);
  EXPECT_NE(done.err.find("PELLUCID_OPENEXR"), std::string::npos) << done.err;
  EXPECT_TRUE(folder.files().empty());
}
#endif

#ifdef PELLUCID_WITH_OPENEXR
TEST(DeepPixels, AreTheFragmentsOfTheImage) {
  const TemporaryFolder folder;
  const Finished done = run_pellucid(
      render(folder, "cpu", {"--pixel", "32,24", "--pixel", "0,0", "--deep", folder.file("d.exr")}));
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json pixels = nlohmann::json::parse(done.out)["deep_pixels"];
  ASSERT_EQ(pixels.size(), 2U);
  const nlohmann::json& fragments = pixels[0]["fragments"];
  ASSERT_GE(fragments.size(), 2U);
  for (std::size_t i = 1; i < fragments.size(); ++i)
    EXPECT_LE(fragments[i - 1]["distance"].get<double>(), fragments[i]["distance"].get<double>());
  EXPECT_TRUE(pixels[1]["fragments"].empty());
  // OpenEXR's own tool takes the file. (exrinfo 3.1 ends with any exit code.)
  EXPECT_EQ(std::system(("exrheader '" + folder.file("d.exr") + "' | grep -q deepscanline").c_str()), 0);
#if defined(PELLUCID_WITH_RENDERER)
  const Finished captured = run_pellucid(render(folder, "sb", {"--pixel", "32,24", "--validation-layers"}));
  ASSERT_EQ(captured.code, 0) << captured.err;
  EXPECT_EQ(captured.err, "");
  const nlohmann::json same = nlohmann::json::parse(captured.out)["deep_pixels"][0]["fragments"];
  ASSERT_EQ(same.size(), fragments.size());
  for (std::size_t i = 0; i < same.size(); ++i) {
    EXPECT_EQ(same[i]["triangle"], fragments[i]["triangle"]);
    for (std::size_t c = 0; c < 4; ++c)
      EXPECT_NEAR(same[i]["color"][c].get<double>(), fragments[i]["color"][c].get<double>(), 0.01);
  }
  EXPECT_EQ(run_pellucid(render(folder, "f2b", {"--pixel", "1,1"})).code, 2);
  EXPECT_EQ(run_pellucid(render(folder, "sb", {"--pixel", "1,1", "--samples", "4"})).code, 2);
#endif
}
#endif

}  // namespace
}  // namespace pellucid::testing
