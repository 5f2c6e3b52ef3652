// How --help looks: the value's name, then what the option does and its default; no types, no checks.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace pellucid::cli {

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(34); }

  [[nodiscard]] std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return {};
    // CLI11 appends what it checks after a colon.
    std::string name = option->get_type_name();
    name = name.substr(0, name.find(':'));
    if (name == "UINT" || name == "INT") name = "N";
    if (name == "FLOAT") name = "X";
    if (option->get_expected_max() > 1) name += "...";
    return name.empty() ? name : " " + name;
  }

  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override {
    const std::string value = option->get_default_str();
    return option->get_description() + (value.empty() ? "" : " (default " + value + ")");
  }
};

}  // namespace pellucid::cli
