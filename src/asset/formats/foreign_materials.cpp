// Implements the materials of foreign_model.h: how models of formats other than glTF look.
#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "asset/formats/foreign_model.h"
#include "asset/formats/images.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

bool begins_as_image(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  std::array<std::byte, 16> first{};
  const std::size_t count = file == nullptr ? 0 : std::fread(first.data(), 1, first.size(), file.get());
  return is_image(std::span<const std::byte>(first.data(), count));
}

class ForeignMaterials {
 public:
  ForeignMaterials(const Model& model, const MaterialOptions& options)
      : model_(model), texels_left_(options.max_texels) {}

  Materials read() {
    for (const Primitive& primitive : model_.primitives) {
      PrimitiveLook& look = result_.primitives.emplace_back();
      look.known = primitive.has_material || !primitive.colors.empty() || !primitive.texture.empty();
      look.base_color = primitive.base_color;
      // Without a statement on opacity, a surface with colours is as opaque as in other programs.
      const bool opaque = !primitive.has_material || primitive.alpha_mode == AlphaMode::opaque;
      look.alpha_mode = look.known && opaque ? AlphaMode::opaque : AlphaMode::blend;
      look.colors = primitive.colors;
      if (primitive.texture.empty()) continue;
      look.texture = texture_of(primitive.texture);
      if (look.texture) look.texcoords = primitive.texcoords;
    }
    return std::move(result_);
  }

 private:
  std::optional<std::uint32_t> texture_of(const std::string& path) {
    if (const auto found = textures_.find(path); found != textures_.end()) return found->second;
    std::optional<std::uint32_t> number;
    if (std::optional<RgbaImage> image = decode(path)) {
      number = static_cast<std::uint32_t>(result_.textures.size());
      ModelTexture& texture = result_.textures.emplace_back();
      texture.image = static_cast<std::uint32_t>(result_.images.size());
      result_.images.push_back(std::move(*image));
    }
    return textures_[path] = number;
  }

  std::optional<RgbaImage> decode(const std::string& path) {
    const std::vector<std::byte> file = read_file(path, kLargestImageFile);
    if (!can_decode(file)) {
      result_.notes.push_back(path +
                              ": it is a JPEG, which this build cannot read (PELLUCID_JPEG is off); "
                              "surfaces are drawn without it");
      return {};
    }
    try {
      RgbaImage image = decode_image(file, texels_left_);
      texels_left_ -= std::uint64_t{image.width} * image.height;
      return image;
    } catch (const ImageFileError& error) {
      throw Error(ErrorKind::bad_input, path + ": " + error.what());
    }
  }

  const Model& model_;
  std::uint64_t texels_left_;
  Materials result_;
  std::map<std::string, std::optional<std::uint32_t>> textures_;
};

}  // namespace

std::string find_texture(Model& model, const std::string& owner, const std::string& name,
                         const std::string& other_path) {
  std::string path = find_beside(model.path, name);
  if (path.empty() && !other_path.empty()) path = find_beside(other_path, name);
  if (!path.empty() && begins_as_image(path)) return path;
  model.notes.push_back(owner + "the texture " + in_quotes(name) +
                        (path.empty() ? " is missing" : " is neither PNG nor JPEG and is left out"));
  return {};
}

Materials read_foreign_materials(const Model& model, const MaterialOptions& options) {
  return ForeignMaterials(model, options).read();
}

}  // namespace pellucid
