// Internal to the module `asset`: constants of the .glb container (glTF 2.0, section 4.4). Little endian
// throughout.
#pragma once

#include <cstdint>

namespace pellucid {

constexpr std::uint32_t kGlbMagic = 0x46546C67;     // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;    // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004E4942;  // "BIN\0"
constexpr std::uint64_t kGlbHeaderBytes = 12;
constexpr std::uint64_t kGlbChunkHeaderBytes = 8;

}  // namespace pellucid
