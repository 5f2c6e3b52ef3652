// Internal to the module `asset`: the header of a PLY file, which declares elements and their properties.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pellucid {

enum class PlyFormat { ascii, binary_little_endian, binary_big_endian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t byte_size(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // Returns the least size of one such element in the file. A word of text takes one byte and a separator.
  [[nodiscard]] std::uint64_t least_bytes(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  // names of images, from comments "TextureFile NAME"
  std::size_t body_begin = 0;         // byte where the data begins
  std::uint64_t body_line = 0;        // its line
};

// Parses the header. Throws Error{bad_input} naming the line.
PlyHeader parse_ply_header(std::string_view text, const std::string& path);

}  // namespace pellucid
