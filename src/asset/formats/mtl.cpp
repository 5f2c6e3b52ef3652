// Reads the materials of OBJ files (Wavefront MTL): diffuse colour, opacity and texture. Ignores lines that
// it does not understand.
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "asset/formats/foreign_model.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

// Reads the next number of the line, if there is one, and clamps it to 0..1.
std::optional<float> unit_number(TextCursor& cursor) {
  const std::optional<float> value = parse_float(cursor.token_on_line());
  if (!value || !(*value == *value)) return {};
  return std::clamp(*value, 0.0F, 1.0F);
}

// Reads "Kd r g b", or one number for all three.
void read_diffuse(TextCursor& cursor, ObjMaterial& material) {
  const std::optional<float> red = unit_number(cursor);
  if (!red) return;
  const float green = unit_number(cursor).value_or(*red);
  const float blue = unit_number(cursor).value_or(*red);
  material.base_color = {*red, green, blue, material.base_color[3]};
}

// Reads "d 0.5" or "d -halo 0.5".
void read_dissolve(TextCursor& cursor, ObjMaterial& material, bool& has_dissolve) {
  TextCursor ahead = cursor;
  if (ahead.token_on_line() == "-halo") cursor = ahead;
  const std::optional<float> opacity = unit_number(cursor);
  if (!opacity) return;
  material.base_color[3] = *opacity;
  has_dissolve = true;
}

void read_transparency(TextCursor& cursor, ObjMaterial& material, bool has_dissolve) {
  const std::optional<float> transparency = unit_number(cursor);
  if (transparency && !has_dissolve && *transparency < 1.0F) material.base_color[3] = 1.0F - *transparency;
}

// Reads "map_Kd -s 2 2 1 -clamp on name of the image.png": options, each with one or more values, then a
// name. Sets `moves` where an option scales or moves the image.
std::string read_map(TextCursor& cursor, bool& moves) {
  for (;;) {
    TextCursor ahead = cursor;
    const std::string_view option = ahead.token_on_line();
    if (option.size() < 2 || option.front() != '-') return std::string(unquoted(cursor.rest_of_line()));
    cursor = ahead;
    const bool vector = option == "-s" || option == "-o" || option == "-t";
    moves = moves || vector;
    const int most = vector ? 3 : option == "-mm" ? 2 : 1;
    for (int i = 0; i < most; ++i) {
      ahead = cursor;
      const std::string_view value = ahead.token_on_line();
      // Vectors may have fewer than three numbers.
      if (value.empty() || (vector && i > 0 && !parse_float(value))) break;
      cursor = ahead;
    }
  }
}

}  // namespace

void parse_obj_materials(std::string_view text, ObjMaterials& materials) {
  TextCursor cursor("", text, '#');
  ObjMaterial* material = nullptr;
  bool has_dissolve = false;
  while (!cursor.at_end()) {
    const std::string_view keyword = cursor.token_on_line();
    bool ignored = false;
    if (keyword == "newmtl") {
      material = &(materials[std::string(unquoted(cursor.rest_of_line()))] = {});
      has_dissolve = false;
    } else if (material != nullptr) {
      if (keyword == "Kd") read_diffuse(cursor, *material);
      if (keyword == "d") read_dissolve(cursor, *material, has_dissolve);
      if (keyword == "Tr") read_transparency(cursor, *material, has_dissolve);
      if (keyword == "map_Kd") material->texture = read_map(cursor, material->moves_texture);
      if (keyword == "map_d") material->opacity_map = read_map(cursor, ignored);
    }
    cursor.skip_line();
  }
}

}  // namespace pellucid
