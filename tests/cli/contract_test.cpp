// Tests what other programs rely on: --help, --version, the common options of every subcommand.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "command_line.h"

namespace pellucid::testing {
namespace {

const std::vector<std::string> kCommands{"order",  "overdraw", "measure", "inspect",
                                         "render", "compare",  "sample",  "techniques"};

// Set PELLUCID_UPDATE_GOLDEN to write the files anew; look at the difference before committing it.
void expect_golden(const std::string& name, const std::string& text) {
  const std::string path = std::string(PELLUCID_GOLDEN) + "/" + name;
  if (std::getenv("PELLUCID_UPDATE_GOLDEN") != nullptr) spill(path, text);
  EXPECT_EQ(text, slurp(path)) << "differs from " << path;
}

TEST(Contract, HelpIsAsWrittenDown) {
  const Finished main = run_pellucid({"--help"});
  EXPECT_EQ(main.code, 0);
  expect_golden("help.txt", main.out);
  for (const std::string& command : kCommands) {
    const Finished help = run_pellucid({command, "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_EQ(help.err, "");
    expect_golden("help-" + command + ".txt", help.out);
  }
}

TEST(Contract, EveryCommandHasTheCommonOptionsAndExamples) {
  for (const std::string& command : kCommands) {
    const std::string help = run_pellucid({command, "--help"}).out;
    for (const char* text :
         {"--help", "--json", "--threads", "--seed", "--quiet", "--verbose", "Examples:"}) {
      EXPECT_NE(help.find(text), std::string::npos) << command << " " << text;
    }
  }
}

TEST(Contract, VersionIsThreeNumbers) {
  const Finished version = run_pellucid({"--version"});
  EXPECT_EQ(version.code, 0);
  int major = -1;
  int minor = -1;
  int patch = -1;
  EXPECT_EQ(std::sscanf(version.out.c_str(), "%d.%d.%d\n", &major, &minor, &patch), 3) << version.out;
}

TEST(Contract, TheReferencePageNamesEveryOption) {
  const std::string page = slurp(std::string(PELLUCID_GOLDEN) + "/../../../docs/command-line.md");
  for (const std::string& command : kCommands) {
    EXPECT_NE(page.find("## pellucid " + command), std::string::npos) << command;
    const std::string help = run_pellucid({command, "--help"}).out;
    for (std::size_t at = 0; (at = help.find("--", at)) != std::string::npos;) {
      const std::size_t end = help.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at);
      const std::string option = help.substr(at, end - at);
      EXPECT_NE(page.find(option), std::string::npos) << command << " " << option;
      at = end;
    }
  }
}

TEST(Contract, TheDocumentNamesEveryTechnique) {
  const std::string page = slurp(std::string(PELLUCID_GOLDEN) + "/../../../docs/rendering.md");
  const Finished listed = run_pellucid({"techniques", "--json", "-"});
  const auto json = nlohmann::json::parse(listed.out.substr(listed.out.find('{')));
  EXPECT_GT(json["techniques"].size(), 0U);
  for (const auto& technique : json["techniques"]) {
    const std::string name = technique["name"];
    EXPECT_NE(page.find("`" + name + "`"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace pellucid::testing
