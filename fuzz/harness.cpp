// libFuzzer's door to one target of readers.h: PELLUCID_FUZZ_TARGET names it.
#include <algorithm>
#include <cstddef>

#include "readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto read = [] {
    const auto targets = pellucid::fuzz::targets();
    return std::find_if(
               targets.begin(), targets.end(),
               [](const pellucid::fuzz::Target& target) { return target.name == PELLUCID_FUZZ_TARGET; })
        ->read;
  }();
  read({data, size});
  return 0;
}
