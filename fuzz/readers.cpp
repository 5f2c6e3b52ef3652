// Implements readers.h. Every format of asset/formats/reader.h is a target; the others are listed at the end.
#include "readers.h"

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "asset/formats/foreign_model.h"
#include "asset/formats/reader.h"
#include "base/record.h"
#include "camera_options.h"
#include "input_file.h"
#include "pellucid/animation.h"
#include "pellucid/asset.h"
#include "pellucid/material.h"
#include "pellucid/scene.h"

namespace pellucid::fuzz {
namespace {

using Input = std::span<const std::uint8_t>;

// Files may say how much there is without holding it: what is within these limits takes no gigabytes.
constexpr ReadOptions kReadLimit{.max_elements = 1U << 18U};
constexpr MaterialOptions kTexelLimit{.max_texels = 1U << 20U};
// Larger models are read, but neither posed nor written.
constexpr std::size_t kMostVertices = 4096;
constexpr std::size_t kMostOfAnything = 64;

[[noreturn]] void broken(const char* promise, const std::string& found) {
  std::fprintf(stderr, "fuzz: broken promise: %s: %s\n", promise, found.c_str());
  std::abort();
}

std::string input_file(Input bytes, std::string_view ending) {
  std::string path = path_for(ending);
  write_input(path, bytes);
  return path;
}

// One line that names the file, of the kind that files give reason for.
void check_complaint(const Error& error, const std::string& path) {
  const std::string text = error.what();
  if (error.kind() != ErrorKind::bad_input && error.kind() != ErrorKind::nothing_to_do)
    broken("complaints about files are bad_input", text);
  if (text.find('\n') != std::string::npos) broken("a complaint is one line", text);
  if (text.find(path) == std::string::npos) broken("a complaint names the file", text);
}

template <class Body>
void read_file_with(const std::string& path, const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    check_complaint(error, path);
  }
}

void check_mesh(const Mesh& mesh) {
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (v >= mesh.positions.size()) broken("indices are in range", std::to_string(v));
    }
  }
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size())
    broken("there are as many normals as positions, or none", std::to_string(mesh.normals.size()));
}

bool is_small(const Model& model) {
  std::size_t vertices = 0;
  for (const Primitive& primitive : model.primitives) vertices += primitive.mesh.positions.size();
  return vertices <= kMostVertices && model.primitives.size() <= kMostOfAnything &&
         model.instances.size() <= kMostOfAnything;
}

void pose(const Model& model) {
  const PosableModel posable(model);
  static_cast<void>(posable.rest_pose());
  std::vector<Vec3f> positions;
  for (std::uint32_t clip = 0; clip < posable.clips().size() && clip < kMostOfAnything; ++clip) {
    const std::vector<double>& times = posable.clips()[clip].key_times;
    posable.pose(clip, times.front(), positions);
    posable.pose(clip, 0.5 * (times.front() + times.back()), positions);
  }
}

// What has been read can be written, unless the file is to blame, and what has been written can be read.
void write_and_read(const Model& model) {
  std::vector<OrderedPrimitive> ordered;
  for (std::uint32_t p = 0; p < model.primitives.size(); ++p) {
    if (model.primitives[p].orders)
      ordered.push_back({p, *model.primitives[p].orders, model.primitives[p].order_error});
  }
  const std::string path = path_for("-written.glb");
  try {
    write_model(model, ordered, path);
  } catch (const Error& error) {
    // Of what nobody has read so far, such as a view that no accessor uses.
    check_complaint(error, model.path);
    return;
  }
  try {
    read_model(path);
  } catch (const Error& error) {
    broken("what was written can be read", error.what());
  }
}

// Reads a model file of any format, and all that belongs to a glTF.
void check_model_file(Input bytes, std::string_view extension) {
  const std::string path = input_file(bytes, extension);
  Model model;
  read_file_with(path, [&] {
    model = read_model(path, kReadLimit);
    for (const Primitive& primitive : model.primitives) check_mesh(primitive.mesh);
  });
  if (model.document == nullptr) return;
  read_file_with(path, [&] { read_rig(model, kReadLimit); });
  read_file_with(path, [&] { read_materials(model, kTexelLimit); });
  read_file_with(path, [&] { read_cameras(model); });
  if (!is_small(model)) return;
  read_file_with(path, [&] { pose(model); });
  write_and_read(model);
}

void read_mtl(Input bytes) {
  ObjMaterials materials;
  try {
    parse_obj_materials({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, materials);
  } catch (const Error& error) {
    // Text in UTF-16 is all that it refuses.
    if (error.kind() != ErrorKind::bad_input) broken("a material file is refused as bad input", error.what());
  }
}

// Textures, and --importance-image. A header may promise up to 2^27 texels, which read_image() allows.
void read_image_file(Input bytes) {
  const std::string path = input_file(bytes, ".png");
  read_file_with(path, [&] {
    const RgbaImage picture = read_image(path);
    if (picture.rgba.size() != std::size_t{4} * picture.width * picture.height)
      broken("an image has four bytes a texel", std::to_string(picture.rgba.size()));
  });
}

void read_camera_path_file(Input bytes) {
  const std::string path = input_file(bytes, ".txt");
  read_file_with(path, [&] { cli::read_camera_path(path); });
}

// Reads the records that --checkpoint continues from, without their checksum.
void read_record(Input bytes) {
  std::vector<std::pair<std::uint32_t, std::vector<float>>> lists;
  static_cast<void>(RecordReader(std::as_bytes(bytes)).read(lists));
  std::map<std::uint16_t, std::vector<std::vector<double>>> map;
  static_cast<void>(RecordReader(std::as_bytes(bytes)).read(map));
}

std::vector<Target> make_targets() {
  std::vector<Target> targets;
  for (const FormatReader& reader : format_readers()) {
    targets.push_back({reader.name, [extension = reader.extensions.front()](Input bytes) {
                         check_model_file(bytes, extension);
                       }});
  }
  targets.push_back({"mtl", read_mtl});
  targets.push_back({"image", read_image_file});
  targets.push_back({"camera_path", read_camera_path_file});
  targets.push_back({"record", read_record});
  return targets;
}

}  // namespace

std::span<const Target> targets() {
  static const std::vector<Target> kTargets = make_targets();
  return kTargets;
}

}  // namespace pellucid::fuzz
