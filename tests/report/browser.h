// Runs a headless browser, for tests of pages with a script. In: a page. Out: what its script made of it.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace pellucid::testing {

// Returns what a shell command prints; nothing if it fails.
inline std::optional<std::string> output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  return ::pclose(pipe) == 0 ? std::optional(text) : std::nullopt;
}

// Returns the path of Chromium or Chrome; nothing if it is not installed.
inline std::optional<std::string> find_browser() {
  const auto found = output_of("command -v chromium chromium-browser google-chrome 2>/dev/null | head -n 1");
  if (!found || found->empty()) return std::nullopt;
  return found->substr(0, found->find('\n'));
}

// Opens `page` with `action` ("--dump-dom" or "--screenshot=FILE") and returns what the browser prints. Time
// in the page is virtual: it runs as fast as the machine can. `folder` holds the browser's own files.
inline std::optional<std::string> open_page(const std::string& browser, const std::string& action,
                                            const std::filesystem::path& page,
                                            const std::filesystem::path& folder) {
  return output_of("timeout 60 " + browser +
                   " --headless=new --no-sandbox --disable-gpu --hide-scrollbars --window-size=1000,1600"
                   " --disable-extensions --disable-dev-shm-usage --no-first-run --virtual-time-budget=10000 "
                   "--user-data-dir='" +
                   folder.string() + "' " + action + " 'file://" + page.string() + "' 2>/dev/null");
}

}  // namespace pellucid::testing
