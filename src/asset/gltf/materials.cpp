// Implements pellucid/material.h for glTF: reads materials, textures and vertex colours of a model.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "asset/formats/foreign_model.h"
#include "asset/formats/images.h"
#include "asset/formats/text_cursor.h"
#include "asset/gltf/accessors.h"
#include "asset/gltf/uris.h"
#include "pellucid/material.h"

namespace pellucid {
namespace {

// A texture as a material uses it.
struct TextureUse {
  std::uint32_t texture = 0;  // index into Materials::textures
  std::uint64_t texcoord = 0;
  // KHR_texture_transform: coordinates are scaled, rotated (radians, counter-clockwise), then translated.
  std::array<double, 2> scale{1, 1}, offset{0, 0};
  double rotation = 0;

  [[nodiscard]] bool same_coordinates(const TextureUse& other) const {
    return texcoord == other.texcoord && scale == other.scale && offset == other.offset &&
           rotation == other.rotation;
  }
};

std::array<float, 2> transformed(const TextureUse& use, float u, float v) {
  const double x = use.scale[0] * static_cast<double>(u);
  const double y = use.scale[1] * static_cast<double>(v);
  const double cosine = std::cos(use.rotation);
  const double sine = std::sin(use.rotation);
  return {static_cast<float>(cosine * x + sine * y + use.offset[0]),
          static_cast<float>(-sine * x + cosine * y + use.offset[1])};
}

class MaterialReader {
 public:
  MaterialReader(const Model& model, const MaterialOptions& options)
      : model_(model),
        root_(model.document->path, model.document->json, ""),
        accessors_(*model.document, {}),
        texels_left_(options.max_texels) {}

  Materials read() {
    for (const Primitive& primitive : model_.primitives) {
      PrimitiveLook& look = result_.primitives.emplace_back();
      look.known = true;
      look.alpha_mode = primitive.alpha_mode;
      look.base_color = primitive.base_color;
      if (primitive.triangles) read_primitive(primitive, look);
    }
    note_what_is_not_drawn();
    return std::move(result_);
  }

 private:
  void read_primitive(const Primitive& primitive, PrimitiveLook& look) {
    if (primitive.new_vertices) {
      throw Error(ErrorKind::bad_argument,
                  model_.path + ": " + primitive.name + " was split; read its materials before splitting");
    }
    const Fields fields =
        root_.element("meshes", primitive.mesh_index).element("primitives", primitive.primitive_index);
    const std::size_t vertices = primitive.mesh.positions.size();
    read_colors(fields, vertices, look);
    const auto index = fields.find_index("material");
    if (!index) return;
    const Fields material = root_.element("materials", *index);
    look.alpha_cutoff = static_cast<float>(material.number_or("alphaCutoff", 0.5));
    let_light_through(material, look);
    look.unlit = material.extension("KHR_materials_unlit").has_value();
    const std::optional<TextureUse> base = base_texture(material);
    if (base) look.texcoords = read_texcoords(fields, *base, vertices);
    if (!look.texcoords.empty()) look.texture = base->texture;
    read_emission(fields, material, base, vertices, look);
    list_what_is_not_drawn(material);
  }

  // Reads the light that a surface gives off. Both textures of a surface share one set of coordinates.
  void read_emission(const Fields& fields, const Fields& material, const std::optional<TextureUse>& base,
                     std::size_t vertices, PrimitiveLook& look) {
    const std::vector<double> factor = material.numbers("emissiveFactor", 3);
    if (look.unlit || factor.empty() || !(factor[0] > 0 || factor[1] > 0 || factor[2] > 0)) return;
    const auto extension = material.extension("KHR_materials_emissive_strength");
    const double strength = extension ? extension->number_or("emissiveStrength", 1) : 1;
    for (std::size_t k = 0; k < 3; ++k) look.emissive.at(k) = static_cast<float>(factor[k] * strength);
    const auto info = material.find_object("emissiveTexture");
    if (!info) return;
    const std::optional<TextureUse> use = use_of(*info);
    if (!use) return;
    if (look.texcoords.empty()) look.texcoords = read_texcoords(fields, *use, vertices);
    const bool same = !look.texture || base->same_coordinates(*use);
    if (same && !look.texcoords.empty()) {
      look.emissive_texture = use->texture;
    } else {
      not_drawn_.insert("emissive textures with coordinates of their own");
      look.emissive = {0, 0, 0};
    }
  }

  // Keeps what a material asks for and the renderer does not draw.
  void list_what_is_not_drawn(const Fields& material) {
    if (material.extension("KHR_materials_unlit")) return;
    list_other_extensions(material);
    if (material.has("normalTexture")) not_drawn_.insert("normal maps");
    if (material.has("occlusionTexture")) not_drawn_.insert("occlusion maps");
    const auto glass = material.extension("KHR_materials_transmission");
    if (glass) not_drawn_.insert("refraction (transmission is drawn as opacity)");
    if (glass && glass->has("transmissionTexture")) not_drawn_.insert("transmission maps");
    if (material.extension("KHR_materials_pbrSpecularGlossiness")) {
      not_drawn_.insert("specular colour and glossiness");
      return;
    }
    const auto pbr = material.find_object("pbrMetallicRoughness");
    const bool map = pbr && pbr->has("metallicRoughnessTexture");
    // What a material does not say is all metal.
    const double metal = pbr ? pbr->number_or("metallicFactor", 1) : 1;
    if (metal > 0) not_drawn_.insert("metal");
    if (map || (pbr && pbr->has("roughnessFactor"))) not_drawn_.insert("roughness");
  }

  // Keeps the names of all extensions of a material that neither this class nor list_what_is_not_drawn()
  // reads.
  void list_other_extensions(const Fields& material) {
    constexpr std::array<const char*, 3> kRead{"KHR_materials_emissive_strength",
                                               "KHR_materials_pbrSpecularGlossiness",
                                               "KHR_materials_transmission"};
    const auto extensions = material.find_object("extensions");
    if (!extensions) return;
    for (const auto& item : extensions->json().items()) {
      const bool read = std::find(kRead.begin(), kRead.end(), item.key()) != kRead.end();
      if (!read) not_drawn_.insert(short_name(item.key()));
    }
  }

  void note_what_is_not_drawn() {
    if (not_drawn_.empty()) return;
    std::string list;
    for (const std::string& what : not_drawn_) list += (list.empty() ? "" : ", ") + what;
    result_.notes.push_back("of its materials these are not drawn: " + list);
  }

  // A transmissive surface lets light through whatever its alpha mode is. It is therefore blended, and keeps
  // some opacity.
  static void let_light_through(const Fields& material, PrimitiveLook& look) {
    constexpr double kLeastOpacity = 0.15;
    const auto extension = material.extension("KHR_materials_transmission");
    const double factor = extension ? extension->number_or("transmissionFactor", 0) : 0;
    if (!(factor > 0)) return;
    if (look.alpha_mode != AlphaMode::blend) look.base_color[3] = 1;
    look.alpha_mode = AlphaMode::blend;
    look.base_color[3] *= static_cast<float>(std::max(1 - factor, kLeastOpacity));
  }

  // Returns the values of an attribute of `fields`, one per vertex, and nothing if it is missing.
  std::vector<float> read_attribute(const Fields& fields, const std::string& name, std::size_t vertices,
                                    std::uint64_t& components) {
    const auto accessor = fields.object("attributes").find_index(name.c_str());
    if (!accessor) return {};
    const std::string type = accessors_.accessor(*accessor).text("type");
    std::vector<float> values = accessors_.read_reals(*accessor, type);
    components = type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
    if (components == 0 || values.size() != components * vertices)
      fields.fail(name + " does not fit its " + std::to_string(vertices) + " positions");
    if (find_non_finite(values) >= 0) fields.fail(name + " holds a number that is not finite");
    return values;
  }

  void read_colors(const Fields& fields, std::size_t vertices, PrimitiveLook& look) {
    std::uint64_t components = 0;
    const std::vector<float> values = read_attribute(fields, "COLOR_0", vertices, components);
    if (values.empty()) return;
    if (components < 3) fields.fail("COLOR_0 is neither VEC3 nor VEC4");
    look.colors.assign(vertices, {1, 1, 1, 1});
    for (std::size_t v = 0; v < vertices; ++v) {
      for (std::size_t k = 0; k < components; ++k)
        look.colors[v].at(k) = std::clamp(values[components * v + k], 0.0F, 1.0F);
    }
  }

  std::vector<std::array<float, 2>> read_texcoords(const Fields& fields, const TextureUse& use,
                                                   std::size_t vertices) {
    const std::string name = "TEXCOORD_" + std::to_string(use.texcoord);
    std::uint64_t components = 0;
    const std::vector<float> values = read_attribute(fields, name, vertices, components);
    if (values.empty()) return {};
    if (components != 2) fields.fail(name + " is not VEC2");
    std::vector<std::array<float, 2>> texcoords;
    texcoords.reserve(vertices);
    for (std::size_t v = 0; v < vertices; ++v)
      texcoords.push_back(transformed(use, values[2 * v], values[2 * v + 1]));
    return texcoords;
  }

  std::optional<TextureUse> base_texture(const Fields& material) {
    std::optional<Fields> info;
    if (const auto glossy = material.extension("KHR_materials_pbrSpecularGlossiness")) {
      info = glossy->find_object("diffuseTexture");
    } else if (const auto pbr = material.find_object("pbrMetallicRoughness")) {
      info = pbr->find_object("baseColorTexture");
    }
    return info ? use_of(*info) : std::nullopt;
  }

  // Reads how a material uses a texture. Returns nothing if its image cannot be read.
  std::optional<TextureUse> use_of(const Fields& info) {
    TextureUse use;
    use.texcoord = info.index_or("texCoord", 0);
    if (const auto transform = info.extension("KHR_texture_transform")) {
      use.texcoord = transform->index_or("texCoord", use.texcoord);
      const std::vector<double> scale = transform->numbers("scale", 2);
      const std::vector<double> offset = transform->numbers("offset", 2);
      std::copy(scale.begin(), scale.end(), use.scale.begin());
      std::copy(offset.begin(), offset.end(), use.offset.begin());
      use.rotation = transform->number_or("rotation", 0);
    }
    const std::optional<std::uint32_t> texture = texture_of(info.index("index"));
    if (!texture) return {};
    use.texture = *texture;
    return use;
  }

  std::optional<std::uint32_t> texture_of(std::uint64_t index) {
    if (const auto found = textures_.find(index); found != textures_.end()) return found->second;
    const Fields texture = root_.element("textures", index);
    const std::optional<std::uint32_t> picture = image_of(texture);
    std::optional<std::uint32_t> number;
    if (picture) {
      number = static_cast<std::uint32_t>(result_.textures.size());
      ModelTexture& read = result_.textures.emplace_back();
      read.image = *picture;
      if (const auto sampler_index = texture.find_index("sampler")) {
        const Fields sampler = root_.element("samplers", *sampler_index);
        read.sampling = sampling_of(sampler);
      }
    }
    return textures_[index] = number;
  }

  static TextureSampling sampling_of(const Fields& sampler) {
    TextureSampling sampling;
    sampling.wrap_u = wrap_of(sampler, "wrapS");
    sampling.wrap_v = wrap_of(sampler, "wrapT");
    sampling.magnify = filter_of(sampler, "magFilter", sampler.index_or("magFilter", kLinear));
    // NEAREST and LINEAR are followed by four values that name a filter within a level and one between
    // levels.
    constexpr std::uint64_t kFirstOfLevels = 9984, kMixed = 9987;
    const std::uint64_t minify = sampler.index_or("minFilter", kMixed);
    if (minify < kFirstOfLevels || minify > kMixed) {
      sampling.minify = filter_of(sampler, "minFilter", minify);
      sampling.levels = TextureLevelsUse::none;
      return sampling;
    }
    const std::uint64_t choice = minify - kFirstOfLevels;
    sampling.minify = (choice & 1U) == 0 ? TextureFilter::nearest : TextureFilter::linear;
    sampling.levels = (choice & 2U) == 0 ? TextureLevelsUse::nearest : TextureLevelsUse::mixed;
    return sampling;
  }

  static constexpr std::uint64_t kNearest = 9728, kLinear = 9729;
  static TextureFilter filter_of(const Fields& sampler, const char* key, std::uint64_t filter) {
    if (filter != kNearest && filter != kLinear)
      sampler.fail(std::string(key) + " " + std::to_string(filter) + " does not exist");
    return filter == kNearest ? TextureFilter::nearest : TextureFilter::linear;
  }

  static TextureWrap wrap_of(const Fields& sampler, const char* key) {
    constexpr std::uint64_t kClamp = 33071, kMirror = 33648, kRepeat = 10497;
    const std::uint64_t wrap = sampler.index_or(key, kRepeat);
    if (wrap == kClamp) return TextureWrap::clamp;
    if (wrap == kMirror) return TextureWrap::mirror;
    if (wrap != kRepeat) sampler.fail(std::string(key) + " " + std::to_string(wrap) + " does not exist");
    return TextureWrap::repeat;
  }

  std::optional<std::uint32_t> image_of(const Fields& texture) {
    const auto source = texture.find_index("source");
    if (!source) {
      note(texture, "it has no image that can be read");
      return {};
    }
    if (const auto found = images_.find(*source); found != images_.end()) return found->second;
    const Fields image = root_.element("images", *source);
    std::optional<std::uint32_t> number;
    if (std::optional<RgbaImage> picture = decode(image)) {
      number = static_cast<std::uint32_t>(result_.images.size());
      result_.images.push_back(std::move(*picture));
    }
    return images_[*source] = number;
  }

  std::optional<RgbaImage> decode(const Fields& image) {
    Bytes storage;
    std::span<const std::byte> file;
    if (const auto view = image.find_index("bufferView")) {
      file = accessors_.view_bytes(*view);
    } else if (const std::string uri = image.text("uri"); is_data_uri(uri)) {
      auto decoded = decode_data_uri(uri);
      if (!decoded) image.fail("the data: uri is malformed");
      storage = std::move(*decoded);
      file = storage;
    } else {
      if (!read_beside(image, uri, storage)) return {};
      file = storage;
    }
    if (!is_image(file)) {
      note(image, "it is neither PNG nor JPEG");
      return {};
    }
    if (!can_decode(file)) {
      note(image, "it is a JPEG, which this build cannot read (PELLUCID_JPEG is off)");
      return {};
    }
    try {
      RgbaImage picture = decode_image(file, texels_left_);
      texels_left_ -= std::uint64_t{picture.width} * picture.height;
      return picture;
    } catch (const ImageFileError& error) {
      image.fail(error.what());
    }
  }

  bool read_beside(const Fields& image, const std::string& uri, Bytes& file) {
    const auto folder = std::filesystem::path(model_.document->path).parent_path();
    const auto relative = relative_path(folder, uri);
    if (!relative) image.fail("uri " + in_quotes(uri, kLongestUri) + " is not a relative path");
    const auto path = folder / *relative;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) {
      note(image, "the file " + in_quotes(*relative, kLongestUri) + " is missing");
      return false;
    }
    file = read_file(path.string(), kLargestImageFile);
    return true;
  }

  void note(const Fields& owner, const std::string& what) {
    result_.notes.push_back(owner.place() + ": " + what + "; surfaces are drawn without it");
  }

  const Model& model_;
  Fields root_;
  AccessorReader accessors_;
  std::uint64_t texels_left_;
  Materials result_;
  // Indexed by their numbers in the file; empty if they cannot be read.
  std::map<std::uint64_t, std::optional<std::uint32_t>> textures_, images_;
  std::set<std::string> not_drawn_;
};

}  // namespace

Materials read_materials(const Model& model, const MaterialOptions& options) {
  if (model.document != nullptr) return MaterialReader(model, options).read();
  return read_foreign_materials(model, options);
}

}  // namespace pellucid
