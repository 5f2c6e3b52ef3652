// Checks whether markup is well formed, for the tests of the module `report`.
#pragma once

#include <cctype>
#include <sstream>
#include <string>
#include <vector>

namespace pellucid::testing {

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Returns the first error in the nesting of tags from the first `root` on; "" if there is none. Void elements
// must be closed as in XML.
inline std::string first_nesting_error(const std::string& page, const std::string& root) {
  std::vector<std::string> open;
  std::size_t at = page.find(root);
  while ((at = page.find('<', at)) != std::string::npos) {
    const bool end_tag = page[at + 1] == '/';
    std::size_t name_end = at + (end_tag ? 2 : 1);
    while (std::isalnum(static_cast<unsigned char>(page[name_end])) != 0) ++name_end;
    const std::string name = page.substr(at + (end_tag ? 2 : 1), name_end - at - (end_tag ? 2 : 1));
    const std::size_t close = page.find('>', at);
    if (close == std::string::npos) return "unclosed tag " + name;
    if (end_tag) {
      if (open.empty() || open.back() != name) return "</" + name + "> at " + page.substr(at, 60);
      open.pop_back();
    } else if (page[close - 1] != '/') {
      open.push_back(name);
      if (name == "style" || name == "script") at = page.find("</" + name, at) - 1;
    }
    ++at;
  }
  return open.empty() ? "" : "never closed: " + open.back();
}

}  // namespace pellucid::testing
