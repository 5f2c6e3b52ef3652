// Connects libFuzzer with one target of readers.h, which PELLUCID_FUZZ_TARGET names.
#include <algorithm>
#include <cstddef>

#include "readers.h"

// libFuzzer gives the name. NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

// NOLINTNEXTLINE(readability-identifier-naming)
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto kRead = [] {
    const auto targets = pellucid::fuzz::targets();
    return std::find_if(
               targets.begin(), targets.end(),
               [](const pellucid::fuzz::Target& target) { return target.name == PELLUCID_FUZZ_TARGET; })
        ->read;
  }();
  kRead({data, size});
  return 0;
}
