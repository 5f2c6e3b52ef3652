// pellucid/material.h - module `asset`: how the surfaces of a model look: colours, opacity, textures.
//
// In: a model that read_model gave. Out: plain data, read and decoded on demand, so that those who order
// meshes do not pay for it. Format: glTF 2.0, sections 3.8 and 3.9, KHR_texture_transform; of OBJ files
// diffuse colours and opacities, without textures.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/asset.h"
#include "pellucid/sampling.h"

namespace pellucid {

// Rows from the upper left; four bytes a texel: sRGB colour and linear opacity, not premultiplied.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

struct ModelTexture {
  std::uint32_t picture = 0;  // index into Materials::pictures
  TextureSampling sampling;
};

// How a primitive looks, beside Model::primitives[i].
struct PrimitiveLook {
  bool known = false;  // the file says something about it
  AlphaMode alpha_mode = AlphaMode::blend;
  std::array<float, 4> base_color{1, 1, 1, 1};  // linear; texture and vertex colours multiply it
  float alpha_cutoff = 0.5F;                    // of AlphaMode::mask
  std::optional<std::uint32_t> texture;         // index into Materials::textures
  std::vector<std::array<float, 2>> texcoords;  // one per vertex, transformed; empty without a texture
  std::vector<std::array<float, 4>> colors;     // one per vertex, linear; empty: all 1
};

struct Materials {
  std::vector<Picture> pictures;
  std::vector<ModelTexture> textures;
  std::vector<PrimitiveLook> primitives;
  std::vector<std::string> notes;  // what could not be read and is drawn without
};

struct MaterialOptions {
  std::uint64_t max_texels = 1ULL << 27U;  // of all pictures together
};

// Pictures that are missing or of another format than PNG and JPEG are left out, with a note. Throws
// Error{bad_input} naming file and place where one is damaged or too large, or where an accessor is wrong;
// Error{bad_argument} where a primitive was split since it was read.
Materials read_materials(const Model& model, const MaterialOptions& options = {});

// A PNG or JPEG. Throws Error{bad_input} where it is missing, damaged or of another format.
Picture read_picture(const std::string& path);

}  // namespace pellucid
