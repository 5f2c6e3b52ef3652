// Implements ply_header.h. Format: Turk, "The PLY polygon file format", 1994.
#include "asset/formats/ply_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "asset/formats/text_cursor.h"
#include "pellucid/base.h"

namespace pellucid {
namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypeNames{{{"char", PlyType::int8},
                                                                           {"int8", PlyType::int8},
                                                                           {"uchar", PlyType::uint8},
                                                                           {"uint8", PlyType::uint8},
                                                                           {"short", PlyType::int16},
                                                                           {"int16", PlyType::int16},
                                                                           {"ushort", PlyType::uint16},
                                                                           {"uint16", PlyType::uint16},
                                                                           {"int", PlyType::int32},
                                                                           {"int32", PlyType::int32},
                                                                           {"uint", PlyType::uint32},
                                                                           {"uint32", PlyType::uint32},
                                                                           {"float", PlyType::float32},
                                                                           {"float32", PlyType::float32},
                                                                           {"double", PlyType::float64},
                                                                           {"float64", PlyType::float64}}};

PlyType read_type(TextCursor& cursor) {
  const std::string_view word = cursor.token_on_line();
  const auto* const found = std::find_if(kTypeNames.begin(), kTypeNames.end(),
                                         [&](const auto& entry) { return entry.first == word; });
  if (found == kTypeNames.end()) throw cursor.error("unknown property type " + in_quotes(word));
  return found->second;
}

PlyFormat read_format(TextCursor& cursor) {
  const std::string_view word = cursor.token_on_line();
  if (word == "ascii") return PlyFormat::ascii;
  if (word == "binary_little_endian") return PlyFormat::binary_little_endian;
  if (word == "binary_big_endian") return PlyFormat::binary_big_endian;
  throw cursor.error("unknown PLY format " + in_quotes(word));
}

PlyElement read_element(TextCursor& cursor) {
  PlyElement element;
  element.name = cursor.token_on_line();
  const std::string_view word = cursor.token_on_line();
  const std::optional<std::int64_t> count = parse_integer(word);
  if (!count || *count < 0) throw cursor.error("bad element count " + in_quotes(word));
  element.count = static_cast<std::uint64_t>(*count);
  return element;
}

PlyProperty read_property(TextCursor& cursor) {
  PlyProperty property;
  TextCursor ahead = cursor;
  if (ahead.token_on_line() == "list") {
    cursor = ahead;
    property.count_type = read_type(cursor);
    if (*property.count_type == PlyType::float32 || *property.count_type == PlyType::float64) {
      throw cursor.error("a list's count must be an integer type");
    }
  }
  property.type = read_type(cursor);
  property.name = cursor.token_on_line();
  if (property.name.empty()) throw cursor.error("the property has no name");
  return property;
}

}  // namespace

std::size_t byte_size(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      break;
  }
  return 8;
}

std::uint64_t PlyElement::least_bytes(PlyFormat format) const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += format == PlyFormat::ascii ? 2 : byte_size(property.count_type.value_or(property.type));
  return bytes;
}

PlyHeader parse_ply_header(std::string_view text, const std::string& path) {
  TextCursor cursor(path, text, '\0');
  if (cursor.token_on_line() != "ply") throw Error(ErrorKind::bad_input, path + ": not a PLY file");
  const std::size_t first_end = text.find_first_of("\r\n");
  const bool cr_alone = text.substr(std::min(first_end, text.size())).starts_with('\r') &&
                        !text.substr(first_end).starts_with("\r\n");
  cursor.skip_line();

  PlyHeader header;
  bool has_format = false;
  while (!cursor.at_end()) {
    const std::string_view keyword = cursor.token_on_line();
    if (keyword == "end_header") {
      if (!has_format) throw cursor.error("the PLY header has no format line");
      cursor.skip_line();
      header.body_begin = text.size() - cursor.remaining();
      // Where CR alone ends the lines of the header, a line feed after the last one belongs to the data.
      if (cr_alone && text[header.body_begin - 1] == '\n' && text[header.body_begin - 2] == '\r')
        --header.body_begin;
      header.body_line = cursor.line();
      return header;
    }
    if (keyword == "format") {
      header.format = read_format(cursor);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(cursor));
    } else if (keyword == "property") {
      if (header.elements.empty()) throw cursor.error("the property stands before any element");
      header.elements.back().properties.push_back(read_property(cursor));
    } else if (keyword == "comment") {
      if (cursor.token_on_line() == "TextureFile")
        header.textures.emplace_back(unquoted(cursor.rest_of_line()));
    } else if (!keyword.empty() && keyword != "obj_info") {
      throw cursor.error("unknown word " + in_quotes(keyword) + " in the PLY header");
    }
    cursor.skip_line();
  }
  throw Error(ErrorKind::bad_input, path + ": the PLY header has no end (end_header is missing)");
}

}  // namespace pellucid
