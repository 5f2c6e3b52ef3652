// The input as a file that read_model() and others can open: on the disk for the test that replays the
// corpora, in memory for libFuzzer, which reads thousands of them a second.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace pellucid::fuzz {

// The path of a file with this end of its name, which may be there already.
std::string path_for(std::string_view ending);
void write_input(const std::string& path, std::span<const std::uint8_t> bytes);

}  // namespace pellucid::fuzz
