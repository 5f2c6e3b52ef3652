// Turns the input into a file that read_model() and others can open. The file lies on the disk for the test
// that replays the corpora, and in memory for libFuzzer, which reads thousands of files a second.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace pellucid::fuzz {

// Returns the path of a file whose name ends like this. The file may exist already.
std::string path_for(std::string_view ending);
void write_input(const std::string& path, std::span<const std::uint8_t> bytes);

}  // namespace pellucid::fuzz
