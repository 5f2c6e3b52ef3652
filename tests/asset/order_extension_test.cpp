// Tests orders in glTF files: orders are read as they were written, in every encoding, and can be removed
// completely.
#include "gltf_helpers.h"

namespace pellucid::test {
namespace {

constexpr OrderEncoding kEncodings[] = {OrderEncoding::indices, OrderEncoding::patches,
                                        OrderEncoding::meshopt};
constexpr PartitionKind kCells[] = {PartitionKind::sampled_triangles, PartitionKind::viewpoints,
                                    PartitionKind::view_triangles, PartitionKind::view_regions};
constexpr SortDirection kDirections[] = {SortDirection::front_to_back, SortDirection::back_to_front};

struct Form {
  OrderEncoding encoding;
  SortDirection direction;
  bool split, bake;
  PartitionKind cells;
  Facing facing;
  const char* extension;
};

std::vector<Form> all_forms() {
  std::vector<Form> forms;
  for (const OrderEncoding encoding : kEncodings) {
    for (const SortDirection direction : kDirections) {
      for (const bool split : {false, true}) {
        for (const bool bake : {false, true}) {
          for (const char* extension : {".glb", ".gltf"}) {
            // Cells and facing vary along, without the full product.
            forms.push_back({encoding, direction, split, bake, kCells[forms.size() * 7 / 3 % 4],
                             forms.size() % 3 == 0 ? Facing::single : Facing::duplicated, extension});
          }
        }
      }
    }
  }
  return forms;
}

class EveryForm : public ::testing::TestWithParam<Form> {
 protected:
  [[nodiscard]] static WriteOptions options() {
    const Form& form = GetParam();
    return {form.encoding, form.direction, form.split, form.bake};
  }
  [[nodiscard]] static OrderSet orders(Random& random, const Mesh& mesh) {
    return random_orders(random, mesh, {GetParam().cells, 1, 2}, 5, GetParam().facing);
  }
  [[nodiscard]] std::string path(const std::string& stem) const {
    return folder_ / (stem + GetParam().extension);
  }

  TempFolder folder_;
};

OrderErrorRecord some_record() {
  OrderErrorRecord record{900, 512, 0.0012, 0.0078, std::numeric_limits<double>::infinity(), {}};
  record.by_distance = {{1.1, 0.25}, {kInfiniteDistance, 1.0 / 3}};
  return record;
}

void expect_same_record(const OrderErrorRecord& a, const OrderErrorRecord& b) {
  EXPECT_EQ(std::tie(a.viewpoints, a.size, a.ipr_mean, a.ipr_max, a.psnr_mean),
            std::tie(b.viewpoints, b.size, b.ipr_mean, b.ipr_max, b.psnr_mean));
  ASSERT_EQ(a.by_distance.size(), b.by_distance.size());
  for (std::size_t i = 0; i < a.by_distance.size(); ++i) {
    EXPECT_EQ(a.by_distance[i].distance, b.by_distance[i].distance);
    EXPECT_EQ(a.by_distance[i].ipr, b.by_distance[i].ipr);
  }
}

// The same drawing, whatever numbers the triangles have.
void expect_same_drawing(const Mesh& mesh_a, const OrderSet& a, const Mesh& mesh_b, const OrderSet& b) {
  EXPECT_EQ(a.partition, b.partition);
  EXPECT_EQ(a.sphere.center, b.sphere.center);
  EXPECT_EQ(a.sphere.radius, b.sphere.radius);
  EXPECT_EQ(a.valid_from, b.valid_from);
  EXPECT_EQ(a.valid_to, b.valid_to);
  EXPECT_EQ(a.facing, b.facing);
  EXPECT_EQ(a.cell_orders, b.cell_orders);
  ASSERT_EQ(a.orders.size(), b.orders.size());
  for (std::size_t i = 0; i < a.orders.size(); ++i) {
    EXPECT_EQ(drawn(mesh_a, a.orders[i]), drawn(mesh_b, b.orders[i])) << "order " << i;
  }
}

void expect_equal(const OrderSet& a, const OrderSet& b) {
  EXPECT_EQ(a.orders, b.orders);
  EXPECT_EQ(a.cell_orders, b.cell_orders);
  EXPECT_EQ(a.base_sequence, b.base_sequence);
}

TEST_P(EveryForm, ComesBackAsWritten) {
  Random random(7);
  const Mesh mesh = random_mesh(random, 40, 60);
  OrderSet set = orders(random, mesh);
  set.orders[3].clear();  // cells that see nothing
  const WriteReport report = write_model(model_of(mesh), {{0, set, some_record()}}, path("a"), options());
  std::uint64_t bytes = 0;
  for (const std::string& file : report.files) bytes += fs::file_size(file);
  EXPECT_EQ(report.file_bytes, bytes);
  EXPECT_EQ(fs::exists(folder_ / "a.orders.bin"), GetParam().split);

  const Model first = read_model(path("a"));
  ASSERT_EQ(first.primitives.size(), 1U);
  const Primitive& primitive = first.primitives[0];
  ASSERT_TRUE(primitive.orders && primitive.order_error);
  expect_same_drawing(mesh, set, primitive.mesh, *primitive.orders);
  expect_same_record(*primitive.order_error, some_record());
  EXPECT_EQ(primitive.mesh.triangles, GetParam().bake ? in_order(mesh, set.base_sequence) : mesh.triangles);
  EXPECT_EQ(primitive.orders->base_sequence, identity(mesh.triangles.size()));
  EXPECT_EQ(primitive.mesh.positions, mesh.positions);

  // Once more: the numbers are settled now, and so are the bytes.
  fs::create_directory(folder_ / "second");
  const std::string second = path("second/a");
  write_model(first, {{0, *primitive.orders, primitive.order_error}}, second, options());
  const Model again = read_model(second);
  ASSERT_TRUE(again.primitives[0].orders);
  expect_equal(*again.primitives[0].orders, *primitive.orders);
  for (const std::string& file : report.files) {
    EXPECT_EQ(file_text(file), file_text(folder_ / ("second/" + fs::path(file).filename().string()))) << file;
  }
}

TEST_P(EveryForm, IsRemovedWithoutATrace) {
  Random random(11);
  HandMade file = pyramid();
  file.json["extras"] =
      Json::parse(R"({"null":null,"float":1.25e-7,"big":12345678901234567,"text":"\u00e4"})");
  file.json["extensionsUsed"] = {"VENDOR_foreign"};
  file.json["extensions"]["VENDOR_foreign"] = {{"a", {1, 2.5, nullptr}}};
  file.buffer.resize(file.buffer.size() + 3);  // odd sizes must survive too
  file.json["buffers"].push_back({{"byteLength", file.buffer.size() - 1}});
  const std::string original = file.save(path("plain"));
  write_model(read_model(original), {}, path("passed"));

  const Model model = read_model(original);
  OrderSet set = orders(random, model.primitives[0].mesh);
  set.base_sequence = identity(6);
  write_model(model, {{0, set, some_record()}}, path("ordered"), options());
  EXPECT_TRUE(json_of(path("ordered")).dump().find("PELLUCID_mesh_primitive_view_orders") !=
              std::string::npos);
  write_model(read_model(path("ordered")), {}, path("stripped"));
  Json expected = json_of(path("passed"));
  Json stripped = json_of(path("stripped"));
  for (Json* json : {&expected, &stripped}) (*json)["buffers"][0].erase("uri");
  EXPECT_EQ(stripped, expected);
  if (std::string(GetParam().extension) == ".glb") {
    EXPECT_EQ(file_text(path("stripped")), file_text(path("passed")));
  }
  EXPECT_EQ(read_model(path("stripped")).primitives[0].mesh.triangles, model.primitives[0].mesh.triangles);
}

TEST_P(EveryForm, OrderingAgainDoesNotGrowTheFile) {
  Random random(13);
  const std::string original = pyramid().save(path("a"));
  std::uint64_t size = 0;
  Model model = read_model(original);
  for (int pass = 0; pass < 4; ++pass) {
    OrderSet set = orders(random, model.primitives[0].mesh);
    set.orders.assign(5, {0, 2, 4, 6, 8, 10});  // the same amount each time
    const WriteReport report = write_model(model, {{0, set, {}}}, path("again"), options());
    if (pass > 0 && GetParam().encoding != OrderEncoding::meshopt) {
      EXPECT_NEAR(static_cast<double>(report.file_bytes), static_cast<double>(size), 80) << "pass " << pass;
    }
    size = report.file_bytes;
    model = read_model(path("again"));
    EXPECT_EQ(json_of(path("again"))["accessors"].size(), 2U + 5U + 1U);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryForm, ::testing::ValuesIn(all_forms()));

// -------------------------------------------------------------------------------------------- validator

// Files for scripts/validate-gltf, in the folder that PELLUCID_VALIDATOR_FILES names (else a temporary one):
// every form, and orders on a file of somebody else's.
TEST(ValidatorFiles, EveryFormIsWritten) {
  const TempFolder temporary;
  const char* asked = std::getenv("PELLUCID_VALIDATOR_FILES");
  const std::string folder = asked != nullptr ? asked : temporary / "files";
  fs::remove_all(folder);
  fs::create_directories(folder);
  Random random(47);
  Mesh mesh = random_mesh(random, 30, 50);
  mesh.normals = mesh.positions;
  const Model own = model_of(mesh);
  const Model foreign = read_model(pyramid().save(temporary / "foreign.gltf"));
  int number = 0;
  for (const Form& form : all_forms()) {
    const std::string name = folder + "/" + std::to_string(number++);
    const WriteOptions options{form.encoding, form.direction, form.split, form.bake};
    for (const Model* model : {&own, &foreign}) {
      const Mesh& part = model->primitives[0].mesh;
      const OrderSet set = random_orders(random, part, {form.cells, 1, 2}, 4, form.facing);
      const std::string path = name + (model == &own ? "-own" : "-foreign") + form.extension;
      write_model(*model, {{0, set, some_record()}}, path, options);
      EXPECT_TRUE(read_model(path).primitives[0].orders);
    }
  }
}

// ------------------------------------------------------------------------------------------------- sizes

TEST(OrderSizes, WidthsFollowTheVertexCount) {
  const TempFolder folder;
  Random random(3);
  for (const std::uint32_t vertices : {65535U, 65536U}) {
    Mesh mesh = random_mesh(random, 100, 30);
    mesh.positions.resize(vertices, {1, 0, 0});
    mesh.triangles.push_back({0, 1, vertices - 1});
    const OrderSet set = random_orders(random, mesh, {}, 2, Facing::duplicated);
    std::uint64_t nodes = set.orders[0].size() + set.orders[1].size();
    const std::uint64_t width = vertices == 65535 ? 2 : 4;
    EXPECT_EQ(index_bytes(set, mesh), 3 * nodes * width);
    const auto plain = write_model(model_of(mesh), {{0, set, {}}}, folder / "a.glb");
    EXPECT_EQ(plain.order_bytes, 3 * nodes * width + 320);
    const auto patches =
        write_model(model_of(mesh), {{0, set, {}}}, folder / "b.glb", {.encoding = OrderEncoding::patches});
    EXPECT_EQ(patches.order_bytes, 2 * nodes + 320);
    expect_same_drawing(mesh, set, read_model(folder / "b.glb").primitives[0].mesh,
                        *read_model(folder / "b.glb").primitives[0].orders);
  }
}

TEST(OrderFiles, MeshoptStreamsAreWhatTheExtensionSays) {
  const TempFolder folder;
  Random random(53);
  const Mesh mesh = random_mesh(random, 100, 300);
  const OrderSet set = random_orders(random, mesh, {}, 3, Facing::duplicated);
  WriteOptions options{.encoding = OrderEncoding::meshopt, .split_buffer = true};
  const WriteReport report = write_model(model_of(mesh), {{0, set, {}}}, folder / "a.glb", options);
  EXPECT_EQ((report.order_bytes + 3) / 4,
            (fs::file_size(folder / "a.orders.bin") + 3) / 4);  // but for padding
  const Json json = json_of(folder / "a.glb");
  const auto compressed = std::find_if(json["bufferViews"].begin(), json["bufferViews"].end(),
                                       [](const Json& view) { return view.contains("extensions"); });
  const Json& stream = (*compressed)["extensions"]["EXT_meshopt_compression"];
  EXPECT_EQ(stream["mode"], "INDICES");
  EXPECT_EQ(stream["count"].get<int>() * stream["byteStride"].get<int>(),
            (*compressed)["byteLength"].get<int>());
  EXPECT_EQ(read_file(folder / "a.orders.bin")[stream["byteOffset"].get<std::size_t>()], std::byte{0xD1});
  EXPECT_EQ(json["buffers"][(*compressed)["buffer"].get<std::size_t>()]["extensions"]
                ["EXT_meshopt_compression"]["fallback"],
            true);

  // The fallback copy may be gone: nobody reads it, and stripping drops the reference to it.
  fs::remove(folder / "a.orders-fallback.bin");
  const Model model = read_model(folder / "a.glb");
  expect_same_drawing(mesh, set, model.primitives[0].mesh, *model.primitives[0].orders);
  write_model(model, {}, folder / "b.glb");
  EXPECT_EQ(json_of(folder / "b.glb")["buffers"].size(), 1U);
  EXPECT_FALSE(json_of(folder / "b.glb").contains("extensionsUsed"));
}

TEST(OrderFiles, ViewersThatDoNotKnowOrdersNeedOnlyTheMainFile) {
  const TempFolder folder;
  Random random(5);
  const Mesh mesh = random_mesh(random, 30, 40);
  const OrderSet set = random_orders(random, mesh, {}, 3, Facing::duplicated);
  WriteOptions options;
  options.split_buffer = true;
  write_model(model_of(mesh), {{0, set, {}}}, folder / "a.glb", options);
  const Json json = json_of(folder / "a.glb");
  for (const Json& view : json["bufferViews"]) EXPECT_EQ(view["buffer"] == 1, !view.contains("target"));
  EXPECT_EQ(json["buffers"][1]["uri"], "a.orders.bin");
  EXPECT_FALSE(json.contains("extensionsRequired"));
}

TEST(OrderBase, SharedIndicesAreNotOverwritten) {
  const TempFolder folder;
  Random random(17);
  HandMade file = pyramid();
  file.json["meshes"][0]["primitives"].push_back(file.primitive());  // the same accessor twice
  const Model model = read_model(file.save(folder / "a.glb"));
  const OrderSet set = random_orders(random, model.primitives[0].mesh, {}, 2, Facing::duplicated);
  write_model(model, {{0, set, {}}}, folder / "b.glb");
  const Model written = read_model(folder / "b.glb");
  EXPECT_EQ(written.primitives[0].mesh.triangles, in_order(model.primitives[0].mesh, set.base_sequence));
  EXPECT_EQ(written.primitives[1].mesh.triangles, model.primitives[1].mesh.triangles);
}

TEST(OrderBase, OverlappingViewsAreNotOverwritten) {
  const TempFolder folder;
  Random random(19);
  HandMade file = pyramid();
  // A second view and accessor over the same bytes.
  file.json["bufferViews"].push_back(file.json["bufferViews"][1]);
  Json twin = file.json["accessors"][1];
  twin["bufferView"] = 2;
  file.json["accessors"].push_back(twin);
  Json second = file.primitive();
  second["indices"] = 2;
  file.json["meshes"][0]["primitives"].push_back(second);
  const Model model = read_model(file.save(folder / "a.glb"));
  const OrderSet set = random_orders(random, model.primitives[0].mesh, {}, 2, Facing::duplicated);
  write_model(model, {{0, set, {}}}, folder / "b.glb");
  EXPECT_EQ(read_model(folder / "b.glb").primitives[1].mesh.triangles, model.primitives[1].mesh.triangles);
}

TEST(OrderBase, TrianglesThatTheOrdersLeaveOutStay) {
  const TempFolder folder;
  const Model model = read_model(pyramid().save(folder / "a.glb"));
  Random random(23);
  OrderSet set = random_orders(random, model.primitives[0].mesh, {}, 2, Facing::duplicated);
  set.base_sequence = {4, 2};
  write_model(model, {{0, set, {}}}, folder / "b.glb");
  EXPECT_EQ(read_model(folder / "b.glb").primitives[0].mesh.triangles,
            in_order(model.primitives[0].mesh, {4, 2, 0, 1, 3, 5}));
}

TEST(OrderBase, ExtensionsThatNumberTrianglesKeepTheirOrder) {
  const TempFolder folder;
  HandMade file = pyramid();
  file.primitive()["extensions"]["EXT_mesh_primitive_edge_visibility"] = {{"visibility", 0}};
  const Model model = read_model(file.save(folder / "a.glb"));
  Random random(29);
  const OrderSet set = random_orders(random, model.primitives[0].mesh, {}, 2, Facing::duplicated);
  write_model(model, {{0, set, {}}}, folder / "b.glb", {.encoding = OrderEncoding::patches});
  const Model written = read_model(folder / "b.glb");
  EXPECT_EQ(written.primitives[0].mesh.triangles, model.primitives[0].mesh.triangles);
  expect_same_drawing(model.primitives[0].mesh, set, written.primitives[0].mesh,
                      *written.primitives[0].orders);
}

TEST(OrderBase, StripsFansAndPlainVerticesBecomeLists) {
  const TempFolder folder;
  Random random(31);
  for (const int mode : {4, 5, 6}) {
    for (const bool indexed : {false, true}) {
      for (const bool bake : {false, true}) {
        HandMade file;
        file.set_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 1});
        if (indexed) file.set_indices(std::vector<std::uint8_t>{5, 4, 3, 2, 1, 0});
        file.primitive()["mode"] = mode;
        const Model model = read_model(file.save(folder / "a.glb"));
        const Mesh& mesh = model.primitives[0].mesh;
        const OrderSet set = random_orders(random, mesh, {}, 3, Facing::duplicated);
        WriteOptions options;
        options.bake_base = bake;
        options.encoding = OrderEncoding::patches;
        write_model(model, {{0, set, {}}}, folder / "b.glb", options);
        const Model written = read_model(folder / "b.glb");
        EXPECT_EQ(written.primitives[0].mesh.triangles,
                  bake ? in_order(mesh, set.base_sequence) : mesh.triangles);
        expect_same_drawing(mesh, set, written.primitives[0].mesh, *written.primitives[0].orders);
      }
    }
  }
}

TEST(OrderNodes, ResolvesDuplicatesAndCoincidentFacingsInOrder) {
  const TempFolder folder;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  // Twice the same triangle, once rotated, and its back: the flipped copy of each is the other side's facing.
  mesh.triangles = {{0, 1, 2}, {1, 2, 0}, {0, 2, 1}};
  Random random(37);
  OrderSet set = random_orders(random, mesh, {}, 1, Facing::duplicated);
  set.orders = {{0, 2, 5, 4, 1, 3}};
  set.base_sequence = identity(3);
  write_model(model_of(mesh), {{0, set, {}}}, folder / "a.glb");
  const Model model = read_model(folder / "a.glb");
  expect_equal(*model.primitives[0].orders, set);
}

// ----------------------------------------------------------------------------------------- bad extensions

class BadOrders : public ::testing::TestWithParam<BadExtension> {};

TEST_P(BadOrders, AreRefusedNamingThePrimitive) {
  const TempFolder folder;
  Random random(41);
  const Mesh mesh = random_mesh(random, 20, 20);
  const OrderSet set = random_orders(random, mesh, {PartitionKind::viewpoints, 1, 0}, 3, Facing::duplicated);
  WriteOptions options;
  options.encoding =
      std::string(GetParam().name).starts_with("Patch") ? OrderEncoding::patches : OrderEncoding::indices;
  write_model(model_of(mesh), {{0, set, {}}}, folder / "a.gltf", options);
  Json json = json_of(folder / "a.gltf");
  GetParam().damage(json["meshes"][0]["primitives"][0]["extensions"]["PELLUCID_mesh_primitive_view_orders"],
                    json);
  write_file_atomically(folder / "a.gltf", json.dump());
  const std::string message = error_of([&] { read_model(folder / "a.gltf"); });
  EXPECT_THAT(message, ::testing::HasSubstr("meshes[0].primitives[0]"));
  EXPECT_THAT(message, ::testing::HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadOrders,
    ::testing::Values(
        BadExtension{"Version", [](Json& e, Json&) { e["version"] = 2; }, "version 2"},
        BadExtension{"NoVersion", [](Json& e, Json&) { e.erase("version"); }, "version is missing"},
        BadExtension{"Sorting", [](Json& e, Json&) { e["sorting"] = "sideways"; }, "neither backToFront"},
        BadExtension{"Facing", [](Json& e, Json&) { e.erase("facing"); }, "facing is missing"},
        BadExtension{"PartitionType", [](Json& e, Json&) { e["partition"]["type"] = "cube"; }, "type 'cube'"},
        BadExtension{"Level", [](Json& e, Json&) { e["partition"]["level"] = 6; }, "level 6"},
        BadExtension{"LevelMismatch", [](Json& e, Json&) { e["partition"]["level"] = 2; },
                     "the partition needs 960"},
        BadExtension{"Cells", [](Json& e, Json&) { e["partition"]["cells"] = "triangles"; },
                     "the partition needs 80"},
        BadExtension{"Range", [](Json& e, Json&) { e["partition"]["maxDistance"] = 0.5; }, "not a range"},
        BadExtension{"Radius", [](Json& e, Json&) { e["partition"]["radius"] = -1; }, "radius"},
        BadExtension{"NoCenter", [](Json& e, Json&) { e["partition"].erase("center"); }, "center"},
        BadExtension{"NoOrders", [](Json& e, Json&) { e["orders"] = Json::array(); }, "no orders"},
        BadExtension{"TooFewOrders", [](Json& e, Json&) { e["orders"].erase(2); }, "of 2"},
        BadExtension{"Fallback", [](Json& e, Json&) { e["fallbackOrder"] = 3; }, "fallbackOrder"},
        BadExtension{"NotTriples",
                     [](Json& e, Json& d) {
                       d["accessors"][e["orders"][0]["indices"].get<std::size_t>()]["count"] = 4;
                     },
                     "no multiple of 3"},
        BadExtension{"NoFacing",
                     [](Json& e, Json& d) {
                       // Shifted by one index, the triples belong to no triangle.
                       Json& accessor = d["accessors"][e["orders"][1]["indices"].get<std::size_t>()];
                       accessor["byteOffset"] = accessor["byteOffset"].get<std::size_t>() + 2;
                     },
                     "no facing of a triangle"},
        BadExtension{"CellDisagrees",
                     [](Json& e, Json& d) {
                       // Reading the table one byte early shifts every corner.
                       Json& view = d["bufferViews"].back();
                       view["byteOffset"] = view["byteOffset"].get<std::size_t>() - 1;
                       e["extras"] = 0;
                     },
                     "cellOrders["},
        BadExtension{"PatchTwice",
                     [](Json& e, Json& d) {
                       const auto first = e["orders"][0]["patches"].get<std::size_t>();
                       d["accessors"][first]["count"] = d["accessors"][first]["count"].get<std::size_t>() + 9;
                     },
                     ""},
        BadExtension{"PatchOffsets", [](Json& e, Json&) { e["patchOffsets"] = e["cellOrders"]; },
                     "patchOffsets"},
        BadExtension{"Strip", [](Json&, Json& d) { d["meshes"][0]["primitives"][0]["mode"] = 5; }, "mode 4"}),
    [](const auto& bad_case) { return bad_case.param.name; });

// ---------------------------------------------------------------------------------------- bad arguments

TEST(BadArguments, AreRefusedBeforeAnythingIsWritten) {
  const TempFolder folder;
  Random random(43);
  const Mesh mesh = random_mesh(random, 10, 8);
  const Model model = model_of(mesh);
  const OrderSet good = random_orders(random, mesh, {}, 2, Facing::single);
  const auto refusal = [&](const std::function<void(OrderedPrimitive&)>& damage,
                           const std::string& name = "a.glb") {
    OrderedPrimitive entry{0, good, {}};
    damage(entry);
    std::string message =
        error_of([&] { write_model(model, {entry}, folder / name); }, ErrorKind::bad_argument);
    EXPECT_FALSE(fs::exists(folder / name));
    return message;
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal([](OrderedPrimitive&) {}, "a.obj"), HasSubstr(".glb or .gltf"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) { e.primitive = 1; }), HasSubstr("primitive 1 of 1"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) { e.orders.orders[0].push_back(16); }),
              HasSubstr("does not exist"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) { e.orders.orders[0] = {2, 2}; }), HasSubstr("twice"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) { e.orders.orders[0] = {3}; }),
              HasSubstr("the facing is single"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) { e.orders.cell_orders[5] = 2; }), HasSubstr("names order 2"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) { e.orders.cell_orders.pop_back(); }), HasSubstr("319 cells"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) {
                e.orders.base_sequence = {0, 0};
              }),
              HasSubstr("base sequence"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) { e.orders.sphere.radius = NAN; }), HasSubstr("sphere"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) { e.orders.valid_to = 0; }), HasSubstr("not a range"));
  EXPECT_THAT(refusal([](OrderedPrimitive& e) {
                e.error.emplace();
                e.error->ipr_mean = NAN;
              }),
              HasSubstr("error record"));
}

}  // namespace
}  // namespace pellucid::test
