// Options with a few named values.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pellucid::cli {

// The help lists the names in the order given here.
template <class Value>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices,
                        const std::string& description) {
  const std::map<std::string, Value> known(choices.begin(), choices.end());
  std::string names;
  for (const auto& choice : choices) names += (names.empty() ? "" : "|") + choice.first;
  const auto set = [&value, known, names, name](const std::string& text) {
    const auto found = known.find(text);
    if (found == known.end()) throw CLI::ValidationError(name, "'" + text + "' is none of " + names);
    value = found->second;
  };
  return command.add_option_function<std::string>(name, set, description)->type_name(names);
}

}  // namespace pellucid::cli
