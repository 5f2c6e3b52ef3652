// Everything in pellucid that reads what others wrote, as functions of bytes. Used by libFuzzer (harness.cpp)
// and by the test that replays what it has found (corpus_test.cpp).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

namespace pellucid::fuzz {

struct Target {
  std::string_view name;  // its seeds lie in fuzz/corpus/NAME
  // Reads the bytes. An Error is fine; calls abort() where it is not of the kind that callers are promised.
  std::function<void(std::span<const std::uint8_t> bytes)> read;
};
// Returns all targets: one for each model format, and those of other files.
std::span<const Target> targets();

}  // namespace pellucid::fuzz
