// Internal to the module `asset`: materials of OBJ files (Wavefront MTL).
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>

namespace pellucid {

struct ObjMaterial {
  // Diffuse colour, and opacity from `d` or, where that is missing, 1 - `Tr`. `Tr 1` without `d` is what
  // MeshLab writes for opaque materials: it is left out.
  std::array<float, 4> base_color{1, 1, 1, 1};
};

// Adds the materials of an MTL file by name; lines that make no sense are left out.
void parse_materials(std::string_view text, std::map<std::string, ObjMaterial, std::less<>>& materials);

}  // namespace pellucid
