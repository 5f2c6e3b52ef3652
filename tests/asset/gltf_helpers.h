// Makes small glTF files by hand, and random order sets, for the tests of the module `asset`.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

#include "pellucid/asset.h"

namespace pellucid::test {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::byte>;
namespace fs = std::filesystem;

// A folder of the test's own, which is removed afterwards.
class TempFolder {
 public:
  TempFolder() {
    // In memory where there is such a place: writing flushes to disk, thousands of times in these tests.
    const fs::path parent = fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    std::string name = (parent / "pellucid-asset-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TempFolder() { fs::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

template <class T>
Bytes bytes_of(const std::vector<T>& values) {
  Bytes bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

inline std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline std::string file_text(const std::string& path) {
  return text_of(read_file(path));
}

inline void put_u32(Bytes& out, std::size_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<std::byte>((value >> shift) & 255U));
}

inline Bytes glb_of(const std::string& json, const Bytes& binary) {
  Bytes out;
  put_u32(out, 0x46546C67);
  put_u32(out, 2);
  put_u32(out, 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size()));
  put_u32(out, json.size());
  put_u32(out, 0x4E4F534A);
  for (const char c : json) out.push_back(static_cast<std::byte>(c));
  if (binary.empty()) return out;
  put_u32(out, binary.size());
  put_u32(out, 0x004E4942);
  out.insert(out.end(), binary.begin(), binary.end());
  return out;
}

// The JSON of a .gltf or .glb.
inline Json json_of(const std::string& path) {
  const Bytes file = read_file(path);
  const std::string text = text_of(file);
  if (!text.starts_with("glTF")) return Json::parse(text);
  std::uint32_t length = 0;
  std::memcpy(&length, file.data() + 12, 4);
  return Json::parse(text.substr(20, length));
}

// A document under construction: one buffer, appended to.
struct HandMade {
  Json json =
      Json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
      "meshes":[{"name":"m","primitives":[{"attributes":{}}]}],"accessors":[],"bufferViews":[],"buffers":[]})");
  Bytes buffer;

  Json& primitive() { return json["meshes"][0]["primitives"][0]; }

  template <class T>
  std::size_t view(const std::vector<T>& values) {
    while (buffer.size() % 4 != 0) buffer.push_back(std::byte{0});
    const Bytes bytes = bytes_of(values);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    buffer.insert(buffer.end(), bytes.begin(), bytes.end());
    return json["bufferViews"].size() - 1;
  }
  std::size_t accessor(std::size_t view_index, int component, std::size_t count, const std::string& type) {
    json["accessors"].push_back(
        {{"bufferView", view_index}, {"componentType", component}, {"count", count}, {"type", type}});
    return json["accessors"].size() - 1;
  }
  template <class T>
  void set_indices(const std::vector<T>& values) {
    const int component = sizeof(T) == 1 ? 5121 : sizeof(T) == 2 ? 5123 : 5125;
    primitive()["indices"] = accessor(view(values), component, values.size(), "SCALAR");
  }
  void set_positions(const std::vector<float>& xyz) {
    const std::size_t id = accessor(view(xyz), 5126, xyz.size() / 3, "VEC3");
    std::array<float, 3> low{xyz[0], xyz[1], xyz[2]};
    std::array<float, 3> high = low;
    for (std::size_t i = 0; i < xyz.size(); ++i) {
      low[i % 3] = std::min(low[i % 3], xyz[i]);
      high[i % 3] = std::max(high[i % 3], xyz[i]);
    }
    json["accessors"][id]["min"] = low;
    json["accessors"][id]["max"] = high;
    primitive()["attributes"]["POSITION"] = id;
  }

  std::string save(const std::string& path) {
    while (buffer.size() % 4 != 0) buffer.push_back(std::byte{0});
    if (json["buffers"].empty()) json["buffers"].push_back({{"byteLength", buffer.size()}});
    if (path.ends_with(".glb")) {
      std::string text = json.dump();
      while (text.size() % 4 != 0) text.push_back(' ');
      write_file_atomically(path, glb_of(text, buffer));
    } else {
      const std::string side = fs::path(path).stem().string() + ".bin";
      if (!json["buffers"][0].contains("uri")) json["buffers"][0]["uri"] = side;
      write_file_atomically((fs::path(path).parent_path() / side).string(), buffer);
      write_file_atomically(path, json.dump(1));
    }
    return path;
  }
};

// Five positions, so that strips and fans differ from lists.
inline std::vector<float> five_points() {
  return {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.5F, 0, 0, 1};
}

inline HandMade pyramid() {
  HandMade file;
  file.set_positions(five_points());
  file.set_indices(std::vector<std::uint16_t>{0, 1, 2, 1, 3, 2, 0, 2, 4, 2, 3, 4, 3, 1, 4, 1, 0, 4});
  return file;
}

// Two pyramids under one moving node, the second one also morphed: two animations.
inline HandMade moving_pyramids() {
  HandMade file = pyramid();
  const std::size_t times = file.accessor(file.view(std::vector<float>{0, 0.5F}), 5126, 2, "SCALAR");
  file.json["accessors"][times]["min"] = {0};
  file.json["accessors"][times]["max"] = {0.5};
  const std::size_t steps = file.accessor(file.view(std::vector<float>{0, 0, 0, 1, 0, 0}), 5126, 2, "VEC3");
  const Json animation = {
      {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
      {"samplers", {{{"input", times}, {"output", steps}}}}};
  file.json["animations"] = {animation, animation};
  Json second = file.primitive();
  second["targets"] = {{{"POSITION", second["attributes"]["POSITION"]}}};
  file.json["meshes"].push_back({{"name", "second"}, {"weights", {0}}, {"primitives", {second}}});
  file.json["nodes"].push_back({{"mesh", 1}});
  file.json["nodes"][0]["children"] = {1};
  return file;
}

// Random points; triangles may repeat and coincide, as in real files.
inline Mesh random_mesh(Random& random, std::uint32_t vertices, std::uint32_t triangles) {
  Mesh mesh;
  for (std::uint32_t v = 0; v < vertices; ++v) mesh.positions.push_back(to_float(random.direction()));
  while (mesh.triangles.size() < triangles) {
    const Triangle t{static_cast<std::uint32_t>(random.below(vertices)),
                     static_cast<std::uint32_t>(random.below(vertices)),
                     static_cast<std::uint32_t>(random.below(vertices))};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  return mesh;
}

template <class T>
void shuffle(std::vector<T>& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(i)]);
}

// Each order holds every triangle in one facing or both, shuffled; cells point anywhere.
inline OrderSet random_orders(Random& random, const Mesh& mesh, const PartitionSpec& partition,
                              std::uint32_t count, Facing facing) {
  OrderSet set;
  set.partition = partition;
  if (partition.kind == PartitionKind::viewpoints) set.partition.sample_level = 0;
  set.sphere = bounding_sphere(mesh);
  set.valid_from = 1.1;
  set.valid_to = random.below(2) == 0 ? kInfiniteDistance : 40.0;
  set.facing = facing;
  const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  for (std::uint32_t k = 0; k < count; ++k) {
    NodeSequence order;
    for (std::uint32_t t = 0; t < triangles; ++t) {
      const std::uint64_t which = facing == Facing::single ? random.below(2) : random.below(4);
      if (which == 0) continue;
      if (which != 2) order.push_back(node_of(t, false));
      if (which > 1) order.push_back(node_of(t, true));
    }
    shuffle(order, random);
    set.orders.push_back(order);
  }
  const std::uint32_t quads = 1U << (2 * partition.level);
  const bool cells_are_triangles = has_triangle_cells(partition);
  set.cell_orders.resize(cells_are_triangles ? 20 * quads : 10 * quads + 2);
  for (std::uint32_t& order : set.cell_orders) order = static_cast<std::uint32_t>(random.below(count));
  set.base_sequence.resize(triangles);
  std::iota(set.base_sequence.begin(), set.base_sequence.end(), 0U);
  shuffle(set.base_sequence, random);
  return set;
}

// Overdraw orders of random patches of a shuffled base, over the cells of `partition`, with key frames of
// these animations.
inline OrderSet random_overdraw_orders(Random& random, const Mesh& mesh, const PartitionSpec& partition,
                                       std::uint32_t count, const std::vector<std::uint32_t>& animations) {
  OrderSet set = random_orders(random, mesh, partition, count, Facing::single);
  set.purpose = OrderPurpose::overdraw;
  const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  set.patch_offsets = {0};
  while (set.patch_offsets.back() < triangles) {
    const std::uint32_t size = 1 + static_cast<std::uint32_t>(random.below(5));
    set.patch_offsets.push_back(std::min(triangles, set.patch_offsets.back() + size));
  }
  std::vector<std::uint32_t> patches(set.patch_offsets.size() - 1);
  std::iota(patches.begin(), patches.end(), 0U);
  for (NodeSequence& order : set.orders) {
    shuffle(patches, random);
    order.clear();
    for (const std::uint32_t p : patches) {
      for (std::uint32_t i = set.patch_offsets[p]; i < set.patch_offsets[p + 1]; ++i) {
        order.push_back(node_of(set.base_sequence[i], false));
      }
    }
    set.model_ranks.push_back(static_cast<std::uint32_t>(random.below(9)));
  }
  for (const std::uint32_t animation : animations) {
    KeyFrameTable table;
    table.animation = animation;
    for (std::uint32_t k = 0; k < 3 + animation; ++k) {
      table.times.push_back(0.25 * k);
      table.spheres.push_back({to_double(to_float(random.direction())), 0.5 * k});
      for (std::size_t cell = 0; cell < set.cell_orders.size(); ++cell) {
        table.cell_orders.push_back(static_cast<std::uint32_t>(random.below(count)));
      }
    }
    set.animations.push_back(table);
  }
  return set;
}

// What an order draws: corner triples, each rotated so that its smallest corner comes first.
inline std::vector<Triangle> drawn(const Mesh& mesh, const NodeSequence& order) {
  std::vector<Triangle> triangles;
  for (const NodeId node : order) {
    const Triangle t = corners_of(mesh, node);
    triangles.push_back(std::min({t, Triangle{t[1], t[2], t[0]}, Triangle{t[2], t[0], t[1]}}));
  }
  return triangles;
}

inline std::vector<std::uint32_t> identity(std::size_t count) {
  std::vector<std::uint32_t> sequence(count);
  std::iota(sequence.begin(), sequence.end(), 0U);
  return sequence;
}

inline std::vector<Triangle> in_order(const Mesh& mesh, const std::vector<std::uint32_t>& sequence) {
  std::vector<Triangle> triangles;
  for (const std::uint32_t t : sequence) triangles.push_back(mesh.triangles[t]);
  return triangles;
}

// Damage to an order extension, and what its refusal must say.
struct BadExtension {
  const char* name;
  std::function<void(Json& extension, Json& document)> damage;
  const char* message;
};

inline Model model_of(const Mesh& mesh) {
  Model model = make_model({{"part", mesh, {0.2F, 0.4F, 0.8F, 0.5F}}}, "hand-made");
  return model;
}

// The message of the pellucid::Error that `action` throws; "" when it throws none.
inline std::string error_of(const std::function<void()>& action, ErrorKind kind = ErrorKind::bad_input) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.kind()), static_cast<int>(kind)) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

}  // namespace pellucid::test
