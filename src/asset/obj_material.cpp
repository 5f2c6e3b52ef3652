// Materials of OBJ files: see obj_material.h.
#include "asset/obj_material.h"

#include <algorithm>
#include <optional>

#include "asset/text_cursor.h"

namespace pellucid {
namespace {

// The next number of the line if there is one, between 0 and 1.
std::optional<float> unit_number(TextCursor& cursor) {
  const std::optional<float> value = parse_float(cursor.token_on_line());
  if (!value || !(*value == *value)) return {};
  return std::clamp(*value, 0.0F, 1.0F);
}

// "Kd r g b", or one number for all three.
void read_diffuse(TextCursor& cursor, ObjMaterial& material) {
  const std::optional<float> red = unit_number(cursor);
  if (!red) return;
  const float green = unit_number(cursor).value_or(*red);
  const float blue = unit_number(cursor).value_or(*red);
  material.base_color = {*red, green, blue, material.base_color[3]};
}

// "d 0.5" or "d -halo 0.5".
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

}  // namespace

void parse_materials(std::string_view text, std::map<std::string, ObjMaterial, std::less<>>& materials) {
  TextCursor cursor("", text, '#');
  ObjMaterial* material = nullptr;
  bool has_dissolve = false;
  while (!cursor.at_end()) {
    const std::string_view keyword = cursor.token_on_line();
    if (keyword == "newmtl") {
      material = &(materials[std::string(cursor.rest_of_line())] = {});
      has_dissolve = false;
    } else if (material != nullptr) {
      if (keyword == "Kd") read_diffuse(cursor, *material);
      if (keyword == "d") read_dissolve(cursor, *material, has_dissolve);
      if (keyword == "Tr") read_transparency(cursor, *material, has_dissolve);
    }
    cursor.skip_line();
  }
}

}  // namespace pellucid
