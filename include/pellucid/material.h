// pellucid/material.h - module `asset`: reads how the surfaces of a model look: colours, opacity, textures.
//
// In: a model that read_model() returned. Out: plain data. It is read and decoded only on demand, because
// ordering a mesh does not need it. Format: glTF 2.0, sections 3.8 and 3.9, KHR_texture_transform,
// KHR_materials_unlit, KHR_materials_emissive_strength, the diffuse part of
// KHR_materials_pbrSpecularGlossiness, and KHR_materials_transmission as opacity. One note names what else of
// the materials is not drawn. OBJ and PLY files give diffuse colours, opacities, vertex colours and textures.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/asset.h"
#include "pellucid/mesh.h"

namespace pellucid {

// A decoded image with opacity, such as a texture uses. Rows begin at the upper left. A texel has four bytes:
// sRGB colour and linear opacity, not premultiplied.
struct RgbaImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

struct ModelTexture {
  std::uint32_t image = 0;  // index into Materials::images
  TextureSampling sampling;
};

// How Model::primitives[i] looks.
struct PrimitiveLook {
  bool known = false;  // the file says something about it
  AlphaMode alpha_mode = AlphaMode::blend;
  std::array<float, 4> base_color{1, 1, 1, 1};    // linear; multiplied by texture and vertex colours
  float alpha_cutoff = 0.5F;                      // for AlphaMode::mask
  bool unlit = false;                             // the colour is what is seen, without light
  std::array<float, 3> emissive{0, 0, 0};         // linear; added to what light makes
  std::optional<std::uint32_t> texture;           // index into Materials::textures
  std::optional<std::uint32_t> emissive_texture;  // multiplies `emissive`
  std::vector<std::array<float, 2>>
      texcoords;                             // of both, one per vertex, transformed; empty without a texture
  std::vector<std::array<float, 4>> colors;  // one per vertex, linear; empty: all 1
};

struct Materials {
  std::vector<RgbaImage> images;
  std::vector<ModelTexture> textures;
  std::vector<PrimitiveLook> primitives;
  std::vector<std::string> notes;  // what could not be read; the model is drawn without it
};

struct MaterialOptions {
  std::uint64_t max_texels = 1ULL << 27U;  // of all images together
};

// Reads the materials of a model. Images that are missing, or in a format other than PNG and JPEG, are left
// out with a note. Throws Error{bad_input} that names the file and the place if an image is damaged or too
// large, or an accessor is wrong. Throws Error{bad_argument} if a primitive was split after it was read.
Materials read_materials(const Model& model, const MaterialOptions& options = {});

// Reads a PNG or JPEG file. Throws Error{bad_input} if it is missing, damaged or of another format.
RgbaImage read_image(const std::string& path);

}  // namespace pellucid
