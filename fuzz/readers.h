// Everything of pellucid that reads what others wrote, as functions of bytes: for libFuzzer (harness.cpp) and
// for the test that replays what it has found (corpus_test.cpp).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace pellucid::fuzz {

struct Target {
  std::string_view name;  // and the folder of its files, fuzz/corpus/NAME
  // Reads the bytes. Complaints are fine; abort() where one is not of the kind that callers are promised.
  void (*read)(std::span<const std::uint8_t> bytes);
};
std::span<const Target> targets();

}  // namespace pellucid::fuzz
