// Tests that options have one meaning everywhere: old names are refused with the new one, and so are options
// without effect.
#include <gtest/gtest.h>

#include "command_line.h"

namespace pellucid::testing {
namespace {

struct Refused {
  Arguments arguments;
  std::string message;  // a part of it
};

void expect_all_refused(const std::vector<Refused>& table) {
  for (const Refused& row : table) {
    std::string line;
    for (const std::string& word : row.arguments) line += word + " ";
    const Finished done = run_pellucid(row.arguments);
    EXPECT_EQ(done.code, 2) << line << done.err;
    EXPECT_EQ(done.out, "") << line;
    EXPECT_NE(done.err.find(row.message), std::string::npos) << line << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << line << done.err;
  }
}

TEST(OptionRules, OldNamesAreRefusedWithTheNewOne) {
  const TemporaryFolder folder;
  const std::string in = samples().plain;
  const std::string out = folder.file("out.glb");
  expect_all_refused({
      {{"order", in, "-o", out, "--views", "S2,2"}, "--views is called --partition here"},
      {{"order", in, "-o", out, "--validate", "0"}, "--validate is called --check-views here"},
      {{"order", "--list", "models.txt", "-o", out}, "--list is called --model-list here"},
      {{"overdraw", in, "--viewpoints", "42"}, "--viewpoints is called --views here"},
      {{"overdraw", in, "--measure", "4"}, "--measure is called --check-views here"},
      {{"overdraw", in, "--pictures=60"}, "--pictures is called --max-images here"},
      {{"order", "--views", "S2,2", in, "-o", out}, "--views is called --partition here"},
      {{"overdraw", "--viewpoints", "42", in}, "--viewpoints is called --views here"},
      {{"measure", in, "--distances", "2,5"}, "--distances is called --distance-range here"},
  });
  EXPECT_TRUE(folder.files().empty());
  for (const char* command : {"order", "overdraw", "measure"}) {
    const std::string help = run_pellucid({command, "--help"}).out;
    EXPECT_EQ(help.find("--validate"), std::string::npos) << command;
    EXPECT_EQ(help.find("is called"), std::string::npos) << command;
  }
}

TEST(OptionRules, OrderRefusesOptionsWithoutEffect) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out.glb");
  const std::string front = folder.file("front.json");
  const auto order = [&](const Arguments& more) {
    Arguments arguments{"order", samples().plain, "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const auto acyclic = [&](const Arguments& more) {
    Arguments arguments = order({"--method", "acyclic"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const auto without_output = [&](const Arguments& more) {
    Arguments arguments{"order", samples().plain, "--frontier", front};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const std::string own = "--method acyclic finds its own number of buffers";
  expect_all_refused({
      {acyclic({"--max-error", "0.1", "--check-views", "0"}), "--max-error would have no effect"},
      {acyclic({"--max-error", "auto"}), own},
      {acyclic({"--min-psnr", "50", "--check-views", "0"}), "--min-psnr would have no effect"},
      {acyclic({"--max-buffers", "3"}), "--max-buffers would have no effect: " + own},
      {acyclic({"--buffers", "3"}), "--buffers would have no effect: " + own},
      {acyclic({"--frontier", front}), "--frontier would have no effect: " + own},
      {order({"--frontier", front, "--dry-run"}), "--frontier would have no effect: --dry-run"},
      {order({"--priority", "union"}), "--priority would have no effect: only --method acyclic"},
      {order({"--relax", "2"}), "--relax would have no effect: only --method acyclic"},
      {order({"--refine", "2", "--upsample-from", "0"}), "--refine would have no effect"},
      {order({"--tolerance", "0.01", "--occlusion", "raster", "--partition", "S1,1"}),
       "--tolerance would have no effect"},
      {order({"--raster-size", "64"}), "--raster-size would have no effect: only --occlusion raster"},
      {order({"--perspective", "--distance", "3"}), "--perspective would have no effect"},
      {order({"--all", "--material", "glass"}), "--all would have no effect"},
      {order({"--split-limit", "0.1"}), "--split-limit would have no effect: only --split"},
      {order({"--cache-method", "tipsify", "--cache", "0"}), "--cache-method would have no effect"},
      {order({"--cache-slack", "0", "--cache", "0"}), "--cache-slack would have no effect: --cache 0"},
      {acyclic({"--cache-slack", "0"}), "--cache-slack would have no effect: --method acyclic"},
      {order({"--cache-slack", "0", "--cache-method", "tipsify"}), "--cache-slack would have no effect"},
      {without_output({"--direction", "back-to-front"}), "--direction would have no effect"},
      {without_output({"--encoding", "patches"}), "--encoding would have no effect"},
      {without_output({"--split-buffer"}), "--split-buffer would have no effect"},
      {without_output({"--no-bake-base"}), "--no-bake-base would have no effect"},
      {without_output({"--check-views", "3"}), "--check-views would have no effect"},
      {without_output({"--skip-existing"}), "--skip-existing would have no effect"},
      {order({"--skip-existing", "--dry-run"}), "--skip-existing would have no effect: --dry-run"},
      {order({"--checkpoint", folder.file("records"), "--dry-run"}), "--checkpoint would have no effect"},
      {order({"--json", "-", "--dry-run"}), "--json would have no effect"},
      {order({"--simplify", "100"}), "--simplify would lose"},
  });
  EXPECT_TRUE(folder.files().empty());
}

TEST(OptionRules, OrderRefusesOptionsWithoutEffectOnTheModel) {
  const TemporaryFolder folder;
  const std::string off = folder.file("triangle.off");
  spill(off, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const std::string out = folder.file("out.glb");
  expect_all_refused({
      {{"order", off, "-o", out, "--all"}, "--all would have no effect: all primitives of a .off file"},
      {{"order", off, "-o", out, "--material", "glass"}, "--material would have no effect: a .off file"},
      {{"order", off, "--dry-run", "--all"}, "--all would have no effect"},
  });
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"triangle.off"}));
}

TEST(OptionRules, OverdrawRefusesOptionsWithoutEffect) {
  const TemporaryFolder folder;
  const std::string off = folder.file("triangle.off");
  spill(off, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const std::string out = folder.file("out.glb");
  expect_all_refused({
      {{"overdraw", off, "--method", "paper", "--acmr", "1"}, "--acmr would have no effect: --method paper"},
      {{"overdraw", off, "--lambda", "3", "--acmr", "1"}, "--acmr would have no effect: --lambda 3"},
      {{"overdraw", off, "--encoding", "indices"}, "--encoding would have no effect: no model is written"},
      {{"overdraw", off, "--split-buffer"}, "--split-buffer would have no effect: no model is written"},
      {{"overdraw", off, "--keyframe-rate", "10"}, "--keyframe-rate would have no effect: nothing in"},
      {{"overdraw", off, "--joint"}, "--joint would have no effect: nothing in"},
      {{"overdraw", off, "--per-animation"}, "--per-animation would have no effect: nothing in"},
      {{"overdraw", off, "--joint", "--per-animation"}, "--joint"},
      {{"overdraw", off, "--animation", "Run"}, "there is no animation 'Run'"},
      {{"overdraw", off, "-o", out, "--subdivide", "1"}, "leave out -o"},
      {{"overdraw", off, "-o", out, "--whole"}, "leave out -o"},
  });
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"triangle.off"}));
}

TEST(OptionRules, OtherCommandsRefuseOptionsWithoutEffect) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out.glb");
  expect_all_refused({
      {{"measure", samples().ordered, "--simplify", "100"}, "--simplify would have no effect"},
      {{"measure", samples().ordered, "--baselines", "all", "--no-baselines"}, "--no-baselines"},
      {{"sample", "--list", "--detail", "2"}, "--detail would have no effect: --list"},
      {{"sample", "--list", "-o", out}, "--output would have no effect: --list"},
      {{"sample", "goblet", "--list"}, "NAME would have no effect: --list"},
  });
  EXPECT_TRUE(folder.files().empty());
}

}  // namespace
}  // namespace pellucid::testing
