// Makes small animated glTF files by hand for the tests of the modules `asset` and `scene`.
#pragma once

#include "asset/gltf_helpers.h"

namespace pellucid::test {

// Returns the type of accessor that an animated path has.
inline std::string type_of(const std::string& path) {
  return path == "weights" ? "SCALAR" : path == "rotation" ? "VEC4" : "VEC3";
}

// Adds a channel of `animation` that moves `node`, with a sampler of its own. Adds animations as needed.
inline void add_channel(HandMade& file, std::size_t animation, int node, const std::string& path,
                        const std::vector<float>& times, const std::vector<float>& values,
                        const std::string& interpolation = "LINEAR") {
  Json& animations = file.json["animations"];
  while (animations.size() <= animation) {
    animations.push_back({{"name", "clip " + std::to_string(animations.size())},
                          {"channels", Json::array()},
                          {"samplers", Json::array()}});
  }
  const std::string type = type_of(path);
  const std::size_t width = type == "SCALAR" ? 1 : type == "VEC4" ? 4 : 3;
  const std::size_t input = file.accessor(file.view(times), 5126, times.size(), "SCALAR");
  const std::size_t output = file.accessor(file.view(values), 5126, values.size() / width, type);
  animations[animation]["samplers"].push_back(
      {{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animations[animation]["channels"].push_back({{"sampler", animations[animation]["samplers"].size() - 1},
                                               {"target", {{"node", node}, {"path", path}}}});
}

template <class T>
std::size_t add_vec4(HandMade& file, const std::vector<T>& values, int component) {
  return file.accessor(file.view(values), component, values.size() / 4, "VEC4");
}

// Returns a ribbon from (0, 0, 0) to (0.5, 2, 0) with three rows of two vertices, which bends at half its
// height. The rows follow joint 0 (node 1), both joints, and joint 1 (node 2, child of node 1, one unit above
// it). The mesh is node 0, whose own transform must have no effect.
inline HandMade ribbon() {
  HandMade file;
  file.set_positions({0, 0, 0, 0.5F, 0, 0, 0, 1, 0, 0.5F, 1, 0, 0, 2, 0, 0.5F, 2, 0});
  file.set_indices(std::vector<std::uint16_t>{0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4});
  Json& attributes = file.primitive()["attributes"];
  attributes["JOINTS_0"] = add_vec4(
      file, std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
      5121);
  attributes["WEIGHTS_0"] =
      add_vec4(file, std::vector<float>{1,    0,    0, 0, 1, 0, 0, 0, 0.25F, 0.75F, 0, 0,
                                        0.5F, 0.5F, 0, 0, 1, 0, 0, 0, 1,     0,     0, 0},
               5126);
  const std::vector<float> inverse_bind{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                        1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
  const std::size_t matrices = file.accessor(file.view(inverse_bind), 5126, 2, "MAT4");
  file.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", matrices}}};
  file.json["nodes"] = Json::parse(R"([{"name":"body","mesh":0,"skin":0,"translation":[9,9,9]},
      {"name":"hip","children":[2]},{"name":"knee","translation":[0,1,0]}])");
  file.json["scenes"] = Json::parse(R"([{"nodes":[0,1]}])");
  return file;
}

// Gives the only primitive one more morph target.
inline void add_target(HandMade& file, const std::vector<float>& deltas) {
  const std::size_t accessor = file.accessor(file.view(deltas), 5126, deltas.size() / 3, "VEC3");
  file.primitive()["targets"].push_back({{"POSITION", accessor}});
}

}  // namespace pellucid::test
