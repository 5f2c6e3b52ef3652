// Tests that options of render and compare have one meaning, and are refused if they have no effect.
#include <gtest/gtest.h>

#include "command_line.h"

namespace pellucid::testing {
namespace {

struct Refusal {
  Arguments options;
  std::string message;  // a part of it
};

// `command` with the model and the output that it needs.
void expect_refused(const Arguments& command, const std::vector<Refusal>& table) {
  for (const Refusal& row : table) {
    Arguments arguments = command;
    arguments.insert(arguments.end(), row.options.begin(), row.options.end());
    std::string line;
    for (const std::string& word : arguments) line += word + " ";
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 2) << line << done.err;
    EXPECT_EQ(done.out, "") << line;
    EXPECT_EQ(count_lines(done.err), 1U) << line << done.err;
    EXPECT_NE(done.err.find(row.message), std::string::npos) << line << done.err;
  }
}

// "--k 4": the option alone is what the message begins with.
Refusal without_effect(const Arguments& options, const std::string& why) {
  return {options, options.front() + " would have no effect: " + why};
}

TEST(CaptureRules, OldNamesAreRefusedWithTheNewOne) {
  const TemporaryFolder folder;
  const std::vector<Refusal> table{{{"--memory", "3MB"}, "--memory is called --device-memory here"},
                                   {{"--validate"}, "--validate is called --validation-layers here"}};
  expect_refused({"render", samples().plain, "-o", folder.file("p.png")}, table);
  expect_refused({"compare", samples().plain, "-o", folder.file("r.html")}, table);
  EXPECT_TRUE(folder.files().empty());
  for (const char* command : {"render", "compare"}) {
    const std::string help = run_pellucid({command, "--help"}).out;
    EXPECT_EQ(help.find("--memory"), std::string::npos) << command;
    EXPECT_EQ(help.find("--validate"), std::string::npos) << command;
  }
}

TEST(CaptureRules, TheCpuRefusesOptionsOfTheDeviceAndOfOtherTechniques) {
  const TemporaryFolder folder;
  const std::string path = folder.file("path.txt");
  const Arguments render{"render", samples().plain, "-o", folder.file("p.png")};
  expect_refused(render, {without_effect({"--frames", "3"}, "technique cpu"),
                          without_effect({"--device", "x"}, "technique cpu"),
                          without_effect({"--validation-layers"}, "technique cpu"),
                          without_effect({"--ignore-orders"}, "technique cpu"),
                          without_effect({"--k", "4"}, "technique cpu does not use it"),
                          without_effect({"--sync", "atomics"}, "technique cpu does not use it"),
                          without_effect({"--heap-from", "4"}, "technique cpu does not use it"),
                          without_effect({"--cull"}, "technique cpu does not use it"),
                          without_effect({"--plain-resolve"}, "technique cpu does not use it"),
                          without_effect({"--pool", "100"}, "technique cpu does not use it"),
                          without_effect({"--overflow", "exact"}, "technique cpu does not use it"),
                          without_effect({"--device-memory", "1MB"}, "technique cpu does not use it"),
                          without_effect({"--allocation", "printed"}, "technique cpu does not use it"),
                          without_effect({"--importance", "none"}, "technique cpu does not use it"),
                          without_effect({"--maps", folder.file("maps")}, "technique cpu does not use it"),
                          without_effect({"--csg", "union"}, "only --effect csg"),
                          without_effect({"--time", "1"}, "there is no --animation"),
                          without_effect({"--camera", "30,20,3", "--path", path}, "the cameras"),
                          without_effect({"--alpha", "0.3", "--effect", "complexity"}, "the effect"),
                          without_effect({"--alpha", "0.3", "--effect", "csg"}, "the effect"),
                          without_effect({"--alpha", "0.3", "--order", "error"}, "--order error shows"),
                          without_effect({"--shading", "depth", "--order", "error"}, "--order error shows"),
                          without_effect({"--order", "original", "--effect", "csg"}, "--effect csg"),
                          without_effect({"--order", "original", "--orbit", "3"}, "--orbit"),
                          without_effect({"--shading", "depth", "--surfaces", "file"}, "--surfaces")});
  EXPECT_TRUE(folder.files().empty());
}

#if defined(PELLUCID_WITH_RENDERER)
TEST(CaptureRules, ATechniqueRefusesOptionsThatItDoesNotUse) {
  const TemporaryFolder folder;
  const auto by = [&](const std::string& technique, const std::vector<Refusal>& table) {
    expect_refused({"render", samples().plain, "-o", folder.file("p.png"), "--technique", technique}, table);
  };
  by("sb", {without_effect({"--k", "4"}, "technique sb does not use it; techniques that do: f2b-kb"),
            without_effect({"--sync", "atomics"}, "technique sb does not use it"),
            without_effect({"--heap-from", "4"}, "technique sb does not use it"),
            without_effect({"--cull"}, "technique sb does not use it"),
            without_effect({"--device-memory", "1MB"}, "technique sb does not use it"),
            without_effect({"--allocation", "printed"}, "technique sb does not use it"),
            without_effect({"--importance", "none"}, "technique sb does not use it"),
            without_effect({"--importance-image", samples().plain}, "technique sb does not use it"),
            without_effect({"--complexity", "0.5,20"}, "technique sb does not use it"),
            without_effect({"--focus", "0,0"}, "technique sb does not use it"),
            without_effect({"--falloff", "2"}, "technique sb does not use it"),
            without_effect({"--importance-noise", "0"}, "technique sb does not use it"),
            without_effect({"--maps", folder.file("maps")}, "technique sb does not use it"),
            without_effect({"--overflow", "exact"}, "everything fits"),
            without_effect({"--csg", "union"}, "only --effect csg"),
            without_effect({"--shading", "depth"}, "--technique sb"),
            without_effect({"--order", "buffers"}, "--technique sb"),
            without_effect({"--time", "1"}, "there is no --animation")});
  by("f2b", {without_effect({"--pool", "100"}, "technique f2b does not use it"),
             without_effect({"--overflow", "exact"}, "technique f2b does not use it"),
             without_effect({"--plain-resolve"}, "technique f2b does not use it")});
  by("kb", {without_effect({"--heap-from", "4"}, "technique kb does not use it")});
  by("k-plus", {without_effect({"--k", "4"}, "technique k-plus does not use it"),
                without_effect({"--importance", "none"}, "technique k-plus does not use it"),
                without_effect({"--heap-from", "4"}, "only --sync interlock"),
                without_effect({"--heap-from", "4", "--sync", "atomics"}, "only --sync interlock")});
  by("hybrid", {without_effect({"--k", "4", "--device-memory", "1MB"}, "--device-memory decides")});
  by("multikb", {without_effect({"--k", "4", "--device-memory", "1MB"}, "--device-memory decides")});
  by("variable-k",
     {without_effect({"--importance-image", samples().plain}, "only --importance image"),
      without_effect({"--complexity", "0.5,20", "--importance", "opacity"}, "only --importance complexity"),
      without_effect({"--focus", "0,0"}, "only --importance periphery"),
      without_effect({"--falloff", "2"}, "only --importance periphery")});
  by("auto", {without_effect({"--overflow", "exact"}, "everything fits"),
              without_effect({"--complexity", "0.5,20"}, "auto gives out slots"),
              without_effect({"--maps", folder.file("maps")}, "technique auto does not use it"),
              without_effect({"--importance", "none"}, "auto gives out slots"),
              without_effect({"--pool", "100"}, "technique auto does not use it")});
  EXPECT_TRUE(folder.files().empty());
}

TEST(CaptureRules, CompareRefusesWhatNoneOfTheTechniquesUses) {
  const TemporaryFolder folder;
  const auto by = [&](const std::string& techniques, const std::vector<Refusal>& table) {
    expect_refused({"compare", samples().plain, "-o", folder.file("r.html"), "--techniques", techniques},
                   table);
  };
  by("sb,f2b", {without_effect({"--k", "4"}, "the chosen techniques do not use it"),
                without_effect({"--sync", "atomics"}, "the chosen techniques do not use it"),
                without_effect({"--device-memory", "1MB"}, "the chosen techniques do not use it"),
                without_effect({"--importance", "none"}, "the chosen techniques do not use it"),
                without_effect({"--overflow", "exact"}, "everything fits"),
                without_effect({"--alpha", "0.3", "--effect", "complexity"}, "the effect"),
                without_effect({"--csg", "union"}, "only --effect csg")});
  by("sb,ll", {without_effect({"--cull"}, "the chosen techniques do not use it")});
  by("cpu", {without_effect({"--ignore-orders"}, "technique cpu")});
  expect_refused(
      {"compare", "-o", folder.file("r.html"), "--sweep", "depth"},
      {without_effect({"--reference", "cpu"}, "no model"), without_effect({"--flicker", "2"}, "no model")});
  EXPECT_TRUE(folder.files().empty());
}

TEST(CaptureRules, CompareTakesWhatOneOfTheTechniquesUses) {
  const Finished done =
      run_pellucid({"compare", samples().plain, "--techniques", "ll,fab,f2b", "--size", "48x32", "--frames",
                    "1", "--plain-resolve", "--k", "2", "--cull", "--pool", "100000", "--json", "-"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(nlohmann::json::parse(done.out)["scenes"][0]["techniques"].size(), 3U);
}
#endif

}  // namespace
}  // namespace pellucid::testing
