// Building blocks of options: options with named values, options with old names, and checks that options have
// an effect.
#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pellucid/base.h"

namespace pellucid::cli {

// Adds an option that takes one of a few names. The help lists the names in the order given here.
template <class Value>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices,
                        const std::string& description) {
  const std::map<std::string, Value> known(choices.begin(), choices.end());
  std::string names;
  for (const auto& choice : choices) names += (names.empty() ? "" : "|") + choice.first;
  const auto set = [&value, known, names, name](const std::string& text) {
    const auto found = known.find(text);
    if (found == known.end()) throw CLI::ValidationError(name, "'" + text + "' is not one of " + names);
    value = found->second;
  };
  return command.add_option_function<std::string>(name, set, description)->type_name(names);
}

// Adds a hidden option with an old name, with or without a value. Its use is a usage error that names the new
// option: "--views is called --partition here".
inline void refuse_old_option(CLI::App& command, const std::string& old_name, const std::string& new_name) {
  command
      .add_option_function<std::vector<std::string>>(
          old_name,
          [old_name, new_name](const std::vector<std::string>&) {
            throw CLI::ValidationError(old_name + " is called " + new_name + " here");
          })
      ->expected(0, 1)
      ->allow_extra_args(false)
      ->group("");
}

// A rule of a command: `option` has an effect only if `condition` holds. `reason` says why.
struct Need {
  const char* option;
  bool condition;
  std::string reason;
};
inline Need needs(const char* option, bool condition, std::string reason) {
  return {option, condition, std::move(reason)};
}

// Throws Error{bad_argument} for the first option that was given and has no effect.
inline void refuse_without_effect(const CLI::App& command, std::initializer_list<Need> rules) {
  for (const Need& rule : rules) {
    if (rule.condition || command.count(rule.option) == 0) continue;
    throw Error(ErrorKind::bad_argument, std::string(rule.option) + " would have no effect: " + rule.reason);
  }
}

}  // namespace pellucid::cli
