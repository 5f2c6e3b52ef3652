// Implements append_split_vertices() of edit.h: interpolates the attributes of vertices that splitting adds.
// Format: glTF 2.0, section 3.7.2.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <string_view>

#include "asset/gltf/accessors.h"
#include "asset/gltf/edit.h"
#include "asset/gltf/json_fields.h"

namespace pellucid {
namespace {

using Elements = AccessorReader::Elements;

// The meaning of the values of an attribute, which decides how they are interpolated.
enum class Meaning {
  position,  // taken from the split mesh
  linear,    // texture coordinates, colours, displacements of morph targets
  normal,    // linear, then normalised
  tangent,   // as a normal for x, y, z; w is a sign
  // Not interpolated: ids (features, joints without weights) and values without a known meaning.
  nearest,
};

Meaning meaning_of(std::string_view name, bool in_target, const Elements& elements) {
  if (elements.type.starts_with("MAT")) return Meaning::nearest;
  if (in_target) return Meaning::linear;
  if (name == "POSITION") return Meaning::position;
  if (name == "NORMAL") return Meaning::normal;
  if (name == "TANGENT") return Meaning::tangent;
  if (name.starts_with("JOINTS_")) return Meaning::nearest;
  const bool integer = elements.component_type != single_float && !elements.normalized;
  return name.starts_with("_") && integer ? Meaning::nearest : Meaning::linear;
}

std::uint32_t heaviest_source(const SplitVertex& vertex) {
  const auto heaviest = std::max_element(vertex.weights.begin(), vertex.weights.end());
  return vertex.sources[static_cast<std::size_t>(heaviest - vertex.weights.begin())];
}

double component(const Elements& e, std::size_t element, std::size_t k) {
  return static_cast<double>(
      real_at(e.bytes, element * e.element_bytes + k * e.component_bytes, e.component_type, e.normalized));
}

void store(double value, Elements& e, std::size_t element, std::size_t k) {
  store_real(value, e.bytes, element * e.element_bytes + k * e.component_bytes, e.component_type,
             e.normalized);
}

void append_nearest(Elements& e, const SplitVertex& vertex) {
  const std::size_t from = heaviest_source(vertex) * e.element_bytes;
  const Bytes copy(e.bytes.begin() + static_cast<std::ptrdiff_t>(from),
                   e.bytes.begin() + static_cast<std::ptrdiff_t>(from + e.element_bytes));
  e.bytes.insert(e.bytes.end(), copy.begin(), copy.end());
}

void append_mean(Elements& e, Meaning meaning, const SplitVertex& vertex) {
  std::array<double, 4> mean{};
  for (std::size_t k = 0; k < e.components; ++k) {
    for (std::size_t i = 0; i < 3; ++i) mean[k] += vertex.weights[i] * component(e, vertex.sources[i], k);
  }
  if (meaning == Meaning::normal || meaning == Meaning::tangent) {
    const std::size_t nearest = heaviest_source(vertex);
    Vec3d unit = normalized(Vec3d{mean[0], mean[1], mean[2]});
    // Opposite directions have no mean, so the nearest one is used.
    if (unit == Vec3d{})
      unit = {component(e, nearest, 0), component(e, nearest, 1), component(e, nearest, 2)};
    mean[0] = unit.x;
    mean[1] = unit.y;
    mean[2] = unit.z;
  }
  if (meaning == Meaning::tangent) mean[3] = component(e, heaviest_source(vertex), 3);
  const std::size_t element = e.count();
  e.bytes.resize(e.bytes.size() + e.element_bytes);
  for (std::size_t k = 0; k < e.components; ++k) store(mean[k], e, element, k);
}

void append_vertices(Elements& e, Meaning meaning, const Primitive& primitive) {
  if (meaning == Meaning::position) {
    e.component_type = single_float;
    e.component_bytes = sizeof(float);
    e.element_bytes = sizeof(Vec3f);
    e.normalized = false;
    e.bytes.resize(primitive.mesh.positions.size() * sizeof(Vec3f));
    std::memcpy(e.bytes.data(), primitive.mesh.positions.data(), e.bytes.size());
    return;
  }
  for (const SplitVertex& vertex : *primitive.new_vertices) {
    if (meaning == Meaning::nearest) {
      append_nearest(e, vertex);
    } else {
      append_mean(e, meaning, vertex);
    }
  }
}

// Mixes all JOINTS_n and WEIGHTS_n of a primitive. A new vertex follows the heaviest of all joints that its
// sources follow, as many as the attributes can store. Their weights are scaled to sum up to 1.
class SkinMixer {
 public:
  SkinMixer(std::vector<Elements>& joints, std::vector<Elements>& weights)
      : joints_(joints), weights_(weights) {}

  void append(const SplitVertex& vertex) {
    std::vector<Influence> influences = mixed(vertex);
    std::stable_sort(influences.begin(), influences.end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    influences.resize(4 * joints_.size());
    double sum = 0;
    for (const Influence& influence : influences) sum += influence.weight;
    for (Influence& influence : influences) influence.weight = sum > 0 ? influence.weight / sum : 0;
    if (sum > 0) round_to_whole(influences);
    for (std::size_t set = 0; set < joints_.size(); ++set) {
      const std::size_t element = joints_[set].count();
      joints_[set].bytes.resize(joints_[set].bytes.size() + joints_[set].element_bytes);
      weights_[set].bytes.resize(weights_[set].bytes.size() + weights_[set].element_bytes);
      for (std::size_t k = 0; k < 4; ++k) {
        const Influence& influence = influences[4 * set + k];
        store_scalar(influence.joint, joints_[set].bytes,
                     element * joints_[set].element_bytes + k * joints_[set].component_bytes,
                     joints_[set].component_type);
        store(influence.weight, weights_[set], element, k);
      }
    }
  }

 private:
  struct Influence {
    std::uint32_t joint = 0;
    double weight = 0;
  };

  [[nodiscard]] std::vector<Influence> mixed(const SplitVertex& vertex) const {
    std::map<std::uint32_t, double> sums;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t set = 0; set < joints_.size(); ++set) {
        for (std::size_t k = 0; k < 4; ++k) {
          const double weight = vertex.weights[i] * component(weights_[set], vertex.sources[i], k);
          if (!(weight > 0)) continue;
          const std::size_t at =
              vertex.sources[i] * joints_[set].element_bytes + k * joints_[set].component_bytes;
          sums[scalar_at(joints_[set].bytes, at, joints_[set].component_type)] += weight;
        }
      }
    }
    std::vector<Influence> influences;
    influences.reserve(sums.size());
    for (const auto& [joint, weight] : sums) influences.push_back({joint, weight});
    return influences;
  }

  // Quantised weights must sum up to 1 as they are stored, so the heaviest weight absorbs the rounding error.
  void round_to_whole(std::vector<Influence>& influences) const {
    if (weights_.front().component_type == single_float) return;
    const double steps = weights_.front().component_type == unsigned_byte ? 255 : 65535;
    double rest = steps;
    for (Influence& influence : influences) {
      influence.weight = std::round(influence.weight * steps);
      rest -= influence.weight;
    }
    influences.front().weight += rest;
    for (Influence& influence : influences) influence.weight /= steps;
  }

  std::vector<Elements>& joints_;
  std::vector<Elements>& weights_;
};

// Returns the least or the largest value of every component, as they are stored.
Json bound_json(const Elements& e, bool largest) {
  Json bound = Json::array();
  for (std::size_t k = 0; k < e.components; ++k) {
    const auto value = [&](std::size_t i) {
      const std::size_t at = i * e.element_bytes + k * e.component_bytes;
      return e.component_type == unsigned_int
                 ? static_cast<double>(scalar_at(e.bytes, at, e.component_type))
                 : static_cast<double>(real_at(e.bytes, at, e.component_type, false));
    };
    double extreme = value(0);
    for (std::size_t i = 1; i < e.count(); ++i) {
      extreme = largest ? std::max(extreme, value(i)) : std::min(extreme, value(i));
    }
    if (e.component_type == single_float) {
      bound.push_back(extreme);
    } else {
      bound.push_back(static_cast<std::int64_t>(extreme));
    }
  }
  return bound;
}

class VertexAppender {
 public:
  VertexAppender(DocumentEditor& editor, Json& json, const Primitive& primitive)
      : editor_(editor), json_(json), primitive_(primitive), reader_(editor.document(), {}) {}

  void run() {
    append_skin();
    for (auto& [name, accessor] : json_["attributes"].items()) {
      if (skin_names_.contains(name)) continue;
      accessor = extended(name, false, accessor_of(accessor, name));
    }
    if (!json_.contains("targets")) return;
    for (Json& target : json_["targets"]) {
      for (auto& [name, accessor] : target.items())
        accessor = extended(name, true, accessor_of(accessor, name));
    }
  }

 private:
  // Attributes that pellucid does not read have not been checked before.
  [[nodiscard]] std::uint64_t accessor_of(const Json& attribute, const std::string& name) const {
    const auto index = as_index(attribute);
    if (!index)
      throw Error(ErrorKind::bad_input,
                  editor_.document().path + ": attribute " + name + " is not a non-negative integer");
    return *index;
  }

  // Reads an attribute, which must have one element for each of the old vertices.
  Elements read(std::uint64_t accessor) {
    Elements elements = reader_.read_elements(accessor);
    const std::size_t vertices = primitive_.mesh.positions.size() - primitive_.new_vertices->size();
    if (elements.count() != vertices) {
      reader_.accessor(accessor).fail("it has " + std::to_string(elements.count()) + " elements for " +
                                      std::to_string(vertices) + " vertices");
    }
    return elements;
  }

  std::uint64_t extended(const std::string& name, bool in_target, std::uint64_t accessor) {
    Elements elements = read(accessor);
    const Meaning meaning = meaning_of(name, in_target, elements);
    // Attributes that share an accessor and have the same meaning continue to share one.
    const auto [known, fresh] = extended_.try_emplace({accessor, meaning}, 0);
    if (!fresh) return known->second;
    append_vertices(elements, meaning, primitive_);
    known->second = write(accessor, elements, meaning == Meaning::position);
    return known->second;
  }

  // Extends joints and weights together.
  void append_skin() {
    std::vector<std::string> names;
    std::vector<Elements> joints;
    std::vector<Elements> weights;
    const Json& attributes = json_["attributes"];
    for (std::size_t set = 0;; ++set) {
      const std::string number = std::to_string(set);
      const auto joint = attributes.find("JOINTS_" + number);
      const auto weight = attributes.find("WEIGHTS_" + number);
      if (joint == attributes.end() || weight == attributes.end()) break;
      joints.push_back(read(accessor_of(*joint, "JOINTS_" + number)));
      weights.push_back(read(accessor_of(*weight, "WEIGHTS_" + number)));
      if (joints.back().components != 4 || weights.back().components != 4) break;
      names.push_back(number);
    }
    joints.resize(names.size());
    weights.resize(names.size());
    if (names.empty()) return;
    SkinMixer mixer(joints, weights);
    for (const SplitVertex& vertex : *primitive_.new_vertices) mixer.append(vertex);
    const auto replace = [&](const std::string& name, const Elements& elements) {
      Json& accessor = json_["attributes"][name];
      accessor = write(accessor_of(accessor, name), elements, false);
      skin_names_.insert(name);
    };
    for (std::size_t set = 0; set < names.size(); ++set) {
      replace("JOINTS_" + names[set], joints[set]);
      replace("WEIGHTS_" + names[set], weights[set]);
    }
  }

  // Appends an accessor like the old one, with a view of its own.
  std::uint64_t write(std::uint64_t old, const Elements& elements, bool needs_bounds) {
    // Elements of vertex attributes begin at multiples of four bytes.
    const std::uint64_t stride = (elements.element_bytes + 3) / 4 * 4;
    Bytes bytes(elements.count() * stride);
    for (std::size_t i = 0; i < elements.count(); ++i) {
      std::memcpy(bytes.data() + i * stride, elements.bytes.data() + i * elements.element_bytes,
                  elements.element_bytes);
    }
    const std::uint64_t view = editor_.append_view(editor_.append_bytes(editor_.host_buffer(), bytes));
    Json& view_json = editor_.document().json["bufferViews"][view];
    if (stride != elements.element_bytes) view_json["byteStride"] = stride;
    view_json["target"] = kVertexTarget;

    Json accessor = editor_.document().json["accessors"][old];
    needs_bounds = needs_bounds || accessor.contains("min") || accessor.contains("max");
    for (const char* key : {"byteOffset", "sparse", "min", "max"}) accessor.erase(key);
    accessor["bufferView"] = view;
    accessor["componentType"] = elements.component_type;
    if (!elements.normalized) accessor.erase("normalized");
    accessor["count"] = elements.count();
    if (needs_bounds) {
      accessor["min"] = bound_json(elements, false);
      accessor["max"] = bound_json(elements, true);
    }
    return editor_.append_accessor(std::move(accessor));
  }

  DocumentEditor& editor_;
  Json& json_;
  const Primitive& primitive_;
  AccessorReader reader_;
  std::map<std::pair<std::uint64_t, Meaning>, std::uint64_t> extended_;
  std::set<std::string> skin_names_;
};

}  // namespace

void append_split_vertices(DocumentEditor& editor, Json& json, const Primitive& primitive) {
  if (primitive.new_vertices->empty()) return;
  VertexAppender(editor, json, primitive).run();
}

}  // namespace pellucid
