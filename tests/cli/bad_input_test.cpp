// Tests bad input: each case gives one line on stderr that names the file, and the right exit code. Nothing
// is left behind.
#include <gtest/gtest.h>
#include <unistd.h>

#include "command_line.h"

namespace pellucid::testing {
namespace {

void expect_refused(const Finished& done, int code, const std::string& file) {
  EXPECT_EQ(done.code, code) << done.err;
  EXPECT_EQ(done.out, "");
  EXPECT_EQ(count_lines(done.err), 1U) << done.err;
  EXPECT_EQ(done.err.rfind("pellucid: ", 0), 0U) << done.err;
  EXPECT_NE(done.err.find(file), std::string::npos) << done.err;
}

class BadInput : public ::testing::Test {
 protected:
  // Every command that reads a model refuses it in the same way.
  void expect_all_refuse(const std::string& name, int code = 3) {
    const std::string path = folder_.file(name);
    expect_refused(run_pellucid(quick_order(path, out_.file("out.glb"))), code, name);
    expect_refused(run_pellucid({"measure", path}), code, name);
    expect_refused(run_pellucid({"inspect", path}), code, name);
    expect_refused(run_pellucid({"render", path, "-o", out_.file("p.png")}), code, name);
    EXPECT_TRUE(out_.files().empty());
  }

  TemporaryFolder folder_;
  TemporaryFolder out_;
};

TEST_F(BadInput, MissingFile) {
  expect_all_refuse("missing.glb");
}

TEST_F(BadInput, EmptyFiles) {
  for (const char* name : {"empty.glb", "empty.gltf", "empty.ply", "empty.stl", "empty.off"}) {
    spill(folder_.file(name), "");
    expect_all_refuse(name);
  }
}

TEST_F(BadInput, Directory) {
  std::filesystem::create_directory(folder_.file("folder.glb"));
  expect_all_refuse("folder.glb");
}

TEST_F(BadInput, TruncatedGlb) {
  const std::string bytes = slurp(samples().ordered);
  for (const std::size_t kept :
       {std::size_t{3}, std::size_t{11}, std::size_t{30}, bytes.size() / 2, bytes.size() - 1}) {
    spill(folder_.file("cut.glb"), bytes.substr(0, kept));
    expect_refused(run_pellucid({"inspect", folder_.file("cut.glb")}), 3, "cut.glb");
  }
}

TEST_F(BadInput, Garbage) {
  std::string garbage;
  unsigned state = 1;
  for (int i = 0; i < 4000; ++i) garbage += static_cast<char>((state = state * 1103515245U + 12345U) >> 16U);
  for (const char* name : {"garbage.glb", "garbage.gltf", "garbage.ply", "garbage.off"}) {
    spill(folder_.file(name), garbage);
    expect_all_refuse(name);
  }
}

TEST_F(BadInput, IndexOutOfRange) {
  spill(folder_.file("range.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  expect_refused(run_pellucid({"inspect", folder_.file("range.obj")}), 3, "range.obj");
}

TEST_F(BadInput, NoPermission) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
  spill(folder_.file("secret.glb"), "x");
  std::filesystem::permissions(folder_.file("secret.glb"), std::filesystem::perms::none);
  expect_all_refuse("secret.glb");
}

TEST_F(BadInput, NamesWithLineBreaksStillMakeOneLine) {
  expect_refused(run_pellucid({"inspect", folder_.file("two\nlines.glb")}), 3, "two lines.glb");
}

TEST(BadOutput, FullDisk) {
  expect_refused(run_pellucid({"inspect", samples().plain}, "/dev/full"), 1, "standard output");
  expect_refused(run_pellucid({"--help"}, "/dev/full"), 1, "standard output");
  expect_refused(run_pellucid({"inspect", samples().plain, "--json", "/dev/full", "--quiet"}), 1,
                 "/dev/full");
}

TEST(BadOutput, MissingFolder) {
  const TemporaryFolder folder;
  const std::string path = folder.file("no/such/out.glb");
  expect_refused(run_pellucid(quick_order(samples().plain, path)), 1, path);
  const std::string png = folder.file("no/p.png");
  expect_refused(run_pellucid({"render", samples().plain, "-o", png, "--size", "16x16"}), 1, png);
}

TEST(BadOutput, IsFoundBeforeAnyWork) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("no/such.file");
  Arguments order = quick_order(samples().plain, folder.file("out.glb"));
  order.insert(order.end(), {"--json", missing});
  expect_refused(run_pellucid(order), 1, missing);
  for (const char* option : {"--json", "--report", "--chart", "--heatmaps"}) {
    expect_refused(run_pellucid({"overdraw", samples().plain, "-o", folder.file("out.glb"), option, missing}),
                   1, missing);
  }
  expect_refused(run_pellucid({"measure", samples().ordered, "--report", missing}), 1, missing);
  expect_refused(run_pellucid({"measure", samples().ordered, "--json", missing}), 1, missing);
  EXPECT_TRUE(folder.files().empty());
}

TEST(BadOutput, ADirectoryIsInTheWay) {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.glb");
  std::filesystem::create_directory(path);
  expect_refused(run_pellucid(quick_order(samples().plain, path)), 1, path);
}

TEST(BadOutput, UnwritableFolder) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("locked"));
  std::filesystem::permissions(folder.file("locked"),
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  expect_refused(run_pellucid(quick_order(samples().plain, folder.file("locked/out.glb"))), 1,
                 "locked/out.glb");
}

TEST(BadUsage, ExitsWith2AndOneLine) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out.glb");
  const std::string in = samples().plain;
  for (const Arguments& bad : {Arguments{},
                               Arguments{"frobnicate"},
                               Arguments{"order"},
                               Arguments{"order", in},
                               Arguments{"order", in, "-o", folder.file("out.obj")},
                               Arguments{"order", in, "-o", out, "--method", "magic"},
                               Arguments{"order", in, "-o", out, "--partition", "Q7"},
                               Arguments{"order", in, "-o", out, "--partition", "S99,2"},
                               Arguments{"order", in, "-o", out, "--cache", "2"},
                               Arguments{"order", in, "-o", out, "--distances", "3,0.5"},
                               Arguments{"order", in, "-o", out, "--distances", "3,"},
                               Arguments{"order", in, "-o", out, "--distances", "nan"},
                               Arguments{"order", in, "-o", out, "--distance", "3", "--orthographic"},
                               Arguments{"order", in, "-o", out, "--perspective", "--orthographic"},
                               Arguments{"order", in, "-o", out, "--buffers", "2", "--max-buffers", "3"},
                               Arguments{"order", in, "-o", out, "--buffers", "2", "--method", "acyclic"},
                               Arguments{"order", in, "-o", out, "--material", "none such"},
                               Arguments{"order", in, "-o", out, "--threads", "-3"},
                               Arguments{"order", in, "-o", out, "--unknown"},
                               Arguments{"measure", in, "--primitive", "99"}}) {
    const Finished done = run_pellucid(bad);
    std::string line;
    for (const std::string& word : bad) line += word + " ";
    EXPECT_EQ(done.code, 2) << line << ": " << done.err;
    EXPECT_EQ(done.out, "") << line;
    EXPECT_EQ(count_lines(done.err), 1U) << line << done.err;
  }
  EXPECT_TRUE(folder.files().empty());
}

}  // namespace
}  // namespace pellucid::testing
