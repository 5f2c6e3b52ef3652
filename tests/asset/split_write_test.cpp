// Tests writing of split primitives into their glTF: every kind of attribute gets the new vertices, and
// nothing else changes.
#include <map>

#include "gltf_helpers.h"

namespace pellucid::test {
namespace {

// Two quads of two triangles each that pass through each other.
std::vector<float> crossing_quads() {
  return {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0, -1, 0.25F, -1, 1, 0.25F, -1, 1, 0.25F, 1, -1, 0.25F, 1};
}
const std::vector<std::uint16_t> kQuadIndices{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
constexpr std::size_t kVertices = 8;

template <class T>
std::vector<T> random_values(std::size_t components, double low, double high, Random& random) {
  std::vector<T> values(kVertices * components);
  for (T& value : values) value = static_cast<T>(random.uniform(low, high));
  return values;
}

template <class T>
void add(HandMade& file, Json& attributes, const std::string& name, const std::string& type, int component,
         bool is_normalized, const std::vector<T>& values) {
  const std::size_t components = values.size() / kVertices;
  // Elements begin at multiples of four bytes.
  const std::size_t stride = (components * sizeof(T) + 3) / 4 * 4;
  Bytes padded(kVertices * stride);
  for (std::size_t i = 0; i < kVertices; ++i)
    std::memcpy(padded.data() + i * stride, values.data() + i * components, components * sizeof(T));
  const std::size_t view = file.view(padded);
  file.json["bufferViews"][view]["byteStride"] = stride;
  const std::size_t id = file.accessor(view, component, kVertices, type);
  if (is_normalized) file.json["accessors"][id]["normalized"] = true;
  attributes[name] = id;
}

HandMade file_with_everything() {
  Random random(7);
  HandMade file;
  file.set_positions(crossing_quads());
  file.set_indices(kQuadIndices);
  Json& a = file.primitive()["attributes"];
  std::vector<float> normals;
  std::vector<float> tangents;
  for (std::size_t i = 0; i < kVertices; ++i) {
    const Vec3f n = to_float(random.direction());
    normals.insert(normals.end(), {n.x, n.y, n.z});
    const Vec3f t = to_float(random.direction());
    tangents.insert(tangents.end(), {t.x, t.y, t.z, i < 4 ? 1.0F : -1.0F});
  }
  add(file, a, "NORMAL", "VEC3", 5126, false, normals);
  add(file, a, "TANGENT", "VEC4", 5126, false, tangents);
  add(file, a, "TEXCOORD_0", "VEC2", 5126, false, random_values<float>(2, 0, 1, random));
  add(file, a, "TEXCOORD_1", "VEC2", 5123, true, random_values<std::uint16_t>(2, 0, 65535, random));
  add(file, a, "TEXCOORD_2", "VEC2", 5122, false, random_values<std::int16_t>(2, -999, 999, random));
  add(file, a, "COLOR_0", "VEC4", 5121, true, random_values<std::uint8_t>(4, 0, 255, random));
  add(file, a, "COLOR_1", "VEC3", 5126, false, random_values<float>(3, 0, 1, random));
  add(file, a, "_FEATURE_ID_0", "SCALAR", 5123, false, random_values<std::uint16_t>(1, 0, 9999, random));
  add(file, a, "_HEAT", "SCALAR", 5126, false, random_values<float>(1, -5, 5, random));
  add(file, a, "_FRAME", "MAT2", 5126, false, random_values<float>(4, -5, 5, random));
  Json target;
  add(file, target, "POSITION", "VEC3", 5126, false, random_values<float>(3, -0.1, 0.1, random));
  add(file, target, "NORMAL", "VEC3", 5120, true, random_values<std::int8_t>(3, -127, 127, random));
  file.primitive()["targets"] = Json::array({target});
  return file;
}

using Element = std::vector<double>;

// Accessors of a .gltf with one .bin, read by a second reader: no sparse parts, no compression.
class PlainReader {
 public:
  explicit PlainReader(const std::string& path) : json(json_of(path)) {
    const std::string name = json["buffers"][0]["uri"];
    bytes_ = read_file((fs::path(path).parent_path() / name).string());
  }

  std::vector<Element> read(std::size_t accessor) const {
    const Json& a = json["accessors"][accessor];
    const Json& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    static const std::map<std::string, std::size_t> kSizes{
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}};
    const std::size_t components = kSizes.at(a["type"]);
    const int type = a["componentType"];
    const std::size_t size = type < 5122 ? 1 : type < 5124 ? 2 : 4;
    const std::size_t stride = view.value("byteStride", components * size);
    EXPECT_EQ(stride % 4, 0U);
    const std::size_t begin =
        view.value("byteOffset", std::size_t{0}) + a.value("byteOffset", std::size_t{0});
    std::vector<Element> elements(a["count"].get<std::size_t>());
    for (std::size_t i = 0; i < elements.size(); ++i) {
      for (std::size_t k = 0; k < components; ++k)
        elements[i].push_back(number(begin + i * stride + k * size, type, a.value("normalized", false)));
    }
    return elements;
  }

  Json json;

 private:
  template <class T>
  double at(std::size_t offset, bool is_normalized) const {
    T value{};
    std::memcpy(&value, bytes_.data() + offset, sizeof(T));
    const auto real = static_cast<double>(value);
    return is_normalized ? real / static_cast<double>(std::numeric_limits<T>::max()) : real;
  }
  double number(std::size_t offset, int type, bool n) const {
    switch (type) {
      case 5120:
        return at<std::int8_t>(offset, n);
      case 5121:
        return at<std::uint8_t>(offset, n);
      case 5122:
        return at<std::int16_t>(offset, n);
      case 5123:
        return at<std::uint16_t>(offset, n);
      case 5125:
        return at<std::uint32_t>(offset, n);
      default:
        return at<float>(offset, n);
    }
  }

  Bytes bytes_;
};

void split_all(Model& model) {
  for (Primitive& primitive : model.primitives) {
    MeshSplit split = split_intersections(primitive.mesh).split;
    primitive.mesh = std::move(split.mesh);
    primitive.new_vertices = std::move(split.new_vertices);
  }
}

std::uint32_t heaviest(const SplitVertex& vertex) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < 3; ++i) best = vertex.weights[i] > vertex.weights[best] ? i : best;
  return vertex.sources[best];
}

Element mean_of(const std::vector<Element>& old, const SplitVertex& vertex) {
  Element mean(old[0].size(), 0.0);
  for (std::size_t k = 0; k < mean.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) mean[k] += vertex.weights[i] * old[vertex.sources[i]][k];
  }
  return mean;
}

void expect_near(const Element& a, const Element& b, double tolerance, const std::string& what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], tolerance) << what << " component " << k;
}

// Half a step of what can be stored.
double rounding_of(const Json& accessor) {
  if (accessor["componentType"] == 5126) return 1e-6;
  if (!accessor.value("normalized", false)) return 0.5;
  const int type = accessor["componentType"];
  return 0.50001 / (type == 5120 ? 127 : type == 5121 ? 255 : type == 5122 ? 32767 : 65535);
}

void scale_to_unit(Element& v) {
  const double l = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (std::size_t k = 0; k < 3; ++k) v[k] /= l;
}

// Every attribute of `after` holds that of `before`, and behind it the right values for the new vertices.
void expect_interpolated(const PlainReader& before, const Json& old_attributes, const PlainReader& after,
                         const Json& new_attributes, const Primitive& primitive, bool in_target) {
  ASSERT_EQ(old_attributes.size(), new_attributes.size());
  for (const auto& [name, id] : old_attributes.items()) {
    const std::vector<Element> old = before.read(id);
    const std::vector<Element> now = after.read(new_attributes[name]);
    const Json& accessor = after.json["accessors"][new_attributes[name].get<std::size_t>()];
    ASSERT_EQ(now.size(), primitive.mesh.positions.size()) << name;
    for (std::size_t i = 0; i < old.size(); ++i) expect_near(now[i], old[i], 0, name);
    for (std::size_t i = 0; i < primitive.new_vertices->size(); ++i) {
      const SplitVertex& vertex = (*primitive.new_vertices)[i];
      Element expected = mean_of(old, vertex);
      if (!in_target && (name == "NORMAL" || name == "TANGENT")) scale_to_unit(expected);
      if (!in_target && name == "TANGENT") expected[3] = old[heaviest(vertex)][3];
      if (name == "_FEATURE_ID_0" || name == "_FRAME") expected = old[heaviest(vertex)];
      expect_near(now[old.size() + i], expected, rounding_of(accessor), name);
    }
    if (accessor.contains("min")) {
      for (std::size_t k = 0; k < now[0].size(); ++k) {
        double low = now[0][k];
        double high = low;
        for (const Element& e : now) {
          low = std::min(low, e[k]);
          high = std::max(high, e[k]);
        }
        EXPECT_EQ(accessor["min"][k], low);
        EXPECT_EQ(accessor["max"][k], high);
      }
    }
  }
}

TEST(SplitFiles, EveryAttributeIsInterpolated) {
  const TempFolder folder;
  const std::string source = file_with_everything().save(folder / "a.gltf");
  Model model = read_model(source);
  split_all(model);
  ASSERT_GE(model.primitives[0].new_vertices->size(), 3U);
  write_model(model, {}, folder / "b.gltf");
  const PlainReader before(source);
  const PlainReader after(folder / "b.gltf");
  const Json& old_json = before.json["meshes"][0]["primitives"][0];
  const Json& new_json = after.json["meshes"][0]["primitives"][0];
  expect_interpolated(before, old_json["attributes"], after, new_json["attributes"], model.primitives[0],
                      false);
  expect_interpolated(before, old_json["targets"][0], after, new_json["targets"][0], model.primitives[0],
                      true);
  const Model read = read_model(folder / "b.gltf");
  EXPECT_EQ(read.primitives[0].mesh.positions, model.primitives[0].mesh.positions);
  EXPECT_EQ(read.primitives[0].mesh.triangles, model.primitives[0].mesh.triangles);
  // Old accessors and views are where they were.
  for (const char* array : {"accessors", "bufferViews"}) {
    for (std::size_t i = 0; i < before.json[array].size(); ++i) {
      EXPECT_EQ(after.json[array][i], before.json[array][i]) << array << i;
    }
  }
}

TEST(SplitFiles, QuantisedPositionsBecomeFloats) {
  const TempFolder folder;
  HandMade file;
  std::vector<std::int16_t> xyz;
  for (const float x : crossing_quads()) xyz.push_back(static_cast<std::int16_t>(32767 * x));
  add(file, file.primitive()["attributes"], "POSITION", "VEC3", 5122, true, xyz);
  file.json["accessors"][0]["min"] = {-32767, -32767, -32767};
  file.json["accessors"][0]["max"] = {32767, 32767, 32767};
  file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.set_indices(kQuadIndices);
  Model model = read_model(file.save(folder / "a.glb"));
  const std::vector<Vec3f> before = model.primitives[0].mesh.positions;
  split_all(model);
  write_model(model, {}, folder / "b.gltf");
  const Json json = json_of(folder / "b.gltf");
  const Json& position =
      json["accessors"][json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(position["componentType"], 5126);
  EXPECT_FALSE(position.contains("normalized"));
  const Mesh read = read_model(folder / "b.gltf").primitives[0].mesh;
  EXPECT_EQ(read.positions, model.primitives[0].mesh.positions);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), read.positions.begin()));
}

TEST(SplitFiles, SparseAccessorsAreResolved) {
  const TempFolder folder;
  HandMade file;
  file.set_positions(crossing_quads());
  file.set_indices(kQuadIndices);
  // No view: zeros, but for two vertices.
  const std::size_t indices = file.view(std::vector<std::uint16_t>{2, 6});
  const std::size_t values = file.view(std::vector<float>{1, 2, 3, 4});
  file.json["accessors"].push_back({{"componentType", 5126},
                                    {"count", kVertices},
                                    {"type", "VEC2"},
                                    {"sparse",
                                     {{"count", 2},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                      {"values", {{"bufferView", values}}}}}});
  file.primitive()["attributes"]["TEXCOORD_0"] = file.json["accessors"].size() - 1;
  Model model = read_model(file.save(folder / "a.glb"));
  split_all(model);
  write_model(model, {}, folder / "b.gltf");
  const PlainReader after(folder / "b.gltf");
  const std::vector<Element> now =
      after.read(after.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"]);
  std::vector<Element> old(kVertices, Element{0, 0});
  old[2] = {1, 2};
  old[6] = {3, 4};
  const auto& vertices = *model.primitives[0].new_vertices;
  for (std::size_t i = 0; i < old.size(); ++i) expect_near(now[i], old[i], 0, "old");
  for (std::size_t i = 0; i < vertices.size(); ++i)
    expect_near(now[kVertices + i], mean_of(old, vertices[i]), 1e-6, "new");
}

TEST(SplitFiles, NewVerticesFollowTheHeaviestJoints) {
  for (const bool quantised : {false, true}) {
    const TempFolder folder;
    HandMade file;
    file.set_positions(crossing_quads());
    file.set_indices(kQuadIndices);
    Json& a = file.primitive()["attributes"];
    Random random(11);
    add(file, a, "JOINTS_0", "VEC4", 5121, false, random_values<std::uint8_t>(4, 0, 6, random));
    if (quantised) {
      std::vector<std::uint8_t> weights;
      for (std::size_t i = 0; i < kVertices; ++i) weights.insert(weights.end(), {100, 80, 50, 25});
      add(file, a, "WEIGHTS_0", "VEC4", 5121, true, weights);
    } else {
      std::vector<float> weights;
      for (std::size_t i = 0; i < kVertices; ++i) weights.insert(weights.end(), {0.4F, 0.3F, 0.2F, 0.1F});
      add(file, a, "WEIGHTS_0", "VEC4", 5126, false, weights);
    }
    const std::string source = file.save(folder / "a.gltf");
    Model model = read_model(source);
    split_all(model);
    write_model(model, {}, folder / "b.gltf");
    const PlainReader before(source);
    const PlainReader after(folder / "b.gltf");
    const Json& old = before.json["meshes"][0]["primitives"][0]["attributes"];
    const Json& now = after.json["meshes"][0]["primitives"][0]["attributes"];
    const std::vector<Element> joints = before.read(old["JOINTS_0"]);
    const std::vector<Element> weights = before.read(old["WEIGHTS_0"]);
    const std::vector<Element> new_joints = after.read(now["JOINTS_0"]);
    const std::vector<Element> new_weights = after.read(now["WEIGHTS_0"]);
    const auto& vertices = *model.primitives[0].new_vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      std::map<double, double> sums;
      for (std::size_t s = 0; s < 3; ++s) {
        const std::uint32_t from = vertices[i].sources[s];
        for (std::size_t k = 0; k < 4; ++k)
          sums[joints[from][k]] += vertices[i].weights[s] * weights[from][k];
      }
      std::vector<double> heaviest_weights;
      for (const auto& [joint, weight] : sums) heaviest_weights.push_back(weight);
      std::sort(heaviest_weights.rbegin(), heaviest_weights.rend());
      heaviest_weights.resize(4);
      const double kept = std::accumulate(heaviest_weights.begin(), heaviest_weights.end(), 0.0);
      double sum = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const double weight = new_weights[kVertices + i][k];
        sum += weight;
        EXPECT_NEAR(weight, heaviest_weights[k] / kept, quantised ? 2.01 / 255 : 1e-6);
        if (weight > 0) {
          EXPECT_NEAR(weight, sums[new_joints[kVertices + i][k]] / kept, quantised ? 2.01 / 255 : 1e-6);
        }
      }
      EXPECT_NEAR(sum, 1, 1e-6);
    }
  }
}

TEST(SplitFiles, PrimitivesThatShareAccessorsGetTheirOwn) {
  const TempFolder folder;
  HandMade file = file_with_everything();
  // A second primitive with the same vertices and one triangle, and a third that is not split.
  Json second = file.primitive();
  second["indices"] =
      file.accessor(file.view(std::vector<std::uint8_t>{0, 2, 3, 4, 5, 6}), 5121, 6, "SCALAR");
  file.json["meshes"][0]["primitives"].push_back(second);
  file.json["meshes"][0]["primitives"].push_back(file.primitive());
  const std::string source = file.save(folder / "a.gltf");
  Model model = read_model(source);
  split_all(model);
  model.primitives[2] = read_model(source).primitives[2];
  Random random(3);
  std::vector<OrderedPrimitive> ordered;
  for (std::uint32_t p = 0; p < 2; ++p) {
    ordered.push_back({p, random_orders(random, model.primitives[p].mesh, {}, 3, Facing::duplicated), {}});
  }
  write_model(model, ordered, folder / "b.gltf");
  const PlainReader before(source);
  const PlainReader after(folder / "b.gltf");
  const Json& old_json = before.json["meshes"][0]["primitives"];
  const Json& new_json = after.json["meshes"][0]["primitives"];
  for (std::size_t p = 0; p < 2; ++p) {
    expect_interpolated(before, old_json[p]["attributes"], after, new_json[p]["attributes"],
                        model.primitives[p], false);
  }
  EXPECT_EQ(new_json[2], old_json[2]);
  const Model read = read_model(folder / "b.gltf");
  for (std::uint32_t p = 0; p < 2; ++p) {
    ASSERT_TRUE(read.primitives[p].orders);
    for (std::size_t i = 0; i < ordered[p].orders.orders.size(); ++i) {
      EXPECT_EQ(drawn(read.primitives[p].mesh, read.primitives[p].orders->orders[i]),
                drawn(model.primitives[p].mesh, ordered[p].orders.orders[i]));
    }
  }
  EXPECT_EQ(read.primitives[2].mesh.triangles, model.primitives[2].mesh.triangles);
}

TEST(SplitFiles, ExtensionsThatNumberTrianglesForbidIt) {
  const TempFolder folder;
  HandMade file = pyramid();
  file.primitive()["extensions"]["FOREIGN_per_triangle"] = {{"colors", {1, 2, 3, 4, 5, 6}}};
  Model model = read_model(file.save(folder / "a.glb"));
  EXPECT_FALSE(triangles_may_change(model, 0));
  model.primitives[0].new_vertices.emplace();
  EXPECT_THAT(error_of([&] { write_model(model, {}, folder / "b.glb"); }, ErrorKind::bad_argument),
              ::testing::HasSubstr("numbers its triangles"));
  EXPECT_FALSE(fs::exists(folder / "b.glb"));
}

TEST(SplitFiles, OrdersOfTheWholeMeshAreNoObstacle) {
  const TempFolder folder;
  Model model = read_model(file_with_everything().save(folder / "a.gltf"));
  Random random(5);
  write_model(model, {{0, random_orders(random, model.primitives[0].mesh, {}, 2, Facing::duplicated), {}}},
              folder / "ordered.glb");
  Model ordered = read_model(folder / "ordered.glb");
  ASSERT_TRUE(ordered.primitives[0].orders);
  EXPECT_TRUE(triangles_may_change(ordered, 0));
  split_all(ordered);
  write_model(ordered, {}, folder / "split.glb");
  const Model read = read_model(folder / "split.glb");
  EXPECT_FALSE(read.primitives[0].orders);
  EXPECT_EQ(read.primitives[0].mesh.triangles, ordered.primitives[0].mesh.triangles);
}

TEST(ValidatorFiles, SplitFilesAreWritten) {
  const TempFolder temporary;
  const char* asked = std::getenv("PELLUCID_VALIDATOR_FILES");
  const std::string folder = asked != nullptr ? asked : temporary / "files";
  fs::create_directories(folder);
  HandMade file = file_with_everything();
  file.primitive().erase("targets");
  file.primitive()["attributes"].erase("TEXCOORD_2");  // needs an extension
  file.primitive()["attributes"].erase("_FRAME");
  Model model = read_model(file.save(temporary / "a.gltf"));
  split_all(model);
  write_model(model, {}, folder + "/split.gltf");
  EXPECT_EQ(read_model(folder + "/split.gltf").primitives[0].mesh.triangles,
            model.primitives[0].mesh.triangles);
}

}  // namespace
}  // namespace pellucid::test
