// Tests overdraw orders in glTF files: patches, model ranks and key frames are read as they were written, in
// every encoding, are shared between primitives, and can be removed again.
#include "gltf_helpers.h"

namespace pellucid::test {
namespace {

struct OverdrawForm {
  OrderEncoding encoding;
  bool split;
  const char* cells;
  const char* extension;
};

std::vector<OverdrawForm> all_overdraw_forms() {
  std::vector<OverdrawForm> forms;
  for (const OrderEncoding encoding :
       {OrderEncoding::indices, OrderEncoding::patches, OrderEncoding::meshopt}) {
    for (const bool split : {false, true}) {
      for (const char* cells : {"S1,1", "P1"}) {
        forms.push_back({encoding, split, cells, forms.size() % 3 == 0 ? ".gltf" : ".glb"});
      }
    }
  }
  return forms;
}

class EveryOverdrawForm : public ::testing::TestWithParam<OverdrawForm> {
 protected:
  [[nodiscard]] static WriteOptions options() {
    WriteOptions options;
    options.encoding = GetParam().encoding;
    options.split_buffer = GetParam().split;
    return options;
  }
  [[nodiscard]] std::string path(const std::string& stem) const {
    return folder_ / (stem + GetParam().extension);
  }
  // Both primitives of one model, with the tables of the model and patches of their own.
  [[nodiscard]] static std::vector<OrderedPrimitive> orders(Random& random, const Model& model) {
    const PartitionSpec partition = parse_partition(GetParam().cells);
    std::vector<OrderedPrimitive> entries;
    for (std::uint32_t p = 0; p < 2; ++p) {
      OrderSet set = random_overdraw_orders(random, model.primitives[p].mesh, partition, 4, {1, 0});
      if (p == 1) {
        set.animations = entries[0].orders.animations;
        set.cell_orders = entries[0].orders.cell_orders;
      }
      entries.push_back({p, set, {}});
    }
    return entries;
  }

  TempFolder folder_;
};

void expect_same_tables(const OrderSet& a, const OrderSet& b) {
  EXPECT_EQ(a.purpose, b.purpose);
  EXPECT_EQ(a.partition, b.partition);
  EXPECT_EQ(a.sphere.center, b.sphere.center);
  EXPECT_EQ(a.sphere.radius, b.sphere.radius);
  EXPECT_EQ(std::tie(a.valid_from, a.valid_to, a.facing), std::tie(b.valid_from, b.valid_to, b.facing));
  EXPECT_EQ(a.cell_orders, b.cell_orders);
  EXPECT_EQ(a.model_ranks, b.model_ranks);
  ASSERT_EQ(a.animations.size(), b.animations.size());
  for (std::size_t i = 0; i < a.animations.size(); ++i) {
    EXPECT_EQ(a.animations[i].animation, b.animations[i].animation);
    EXPECT_EQ(a.animations[i].times, b.animations[i].times);
    EXPECT_EQ(a.animations[i].cell_orders, b.animations[i].cell_orders);
    ASSERT_EQ(a.animations[i].spheres.size(), b.animations[i].spheres.size());
    for (std::size_t k = 0; k < a.animations[i].spheres.size(); ++k) {
      EXPECT_EQ(a.animations[i].spheres[k].center, b.animations[i].spheres[k].center);
      EXPECT_EQ(a.animations[i].spheres[k].radius, b.animations[i].spheres[k].radius);
    }
  }
}

void expect_same_triangles(const Mesh& mesh_a, const OrderSet& a, const Mesh& mesh_b, const OrderSet& b) {
  ASSERT_EQ(a.orders.size(), b.orders.size());
  for (std::size_t i = 0; i < a.orders.size(); ++i) {
    EXPECT_EQ(drawn(mesh_a, a.orders[i]), drawn(mesh_b, b.orders[i])) << "order " << i;
  }
}

const Json& extension_of(const Json& document, std::size_t mesh) {
  return document["meshes"][mesh]["primitives"][0]["extensions"]["PELLUCID_mesh_primitive_view_orders"];
}

TEST_P(EveryOverdrawForm, ComesBackAsWritten) {
  Random random(7);
  const Model model = read_model(moving_pyramids().save(folder_ / "plain.glb"));
  const std::vector<OrderedPrimitive> entries = orders(random, model);
  const WriteReport report = write_model(model, entries, path("a"), options());

  const Model first = read_model(path("a"));
  std::vector<OrderedPrimitive> again;
  for (std::uint32_t p = 0; p < 2; ++p) {
    const Primitive& primitive = first.primitives[p];
    const OrderSet& set = entries[p].orders;
    ASSERT_TRUE(primitive.orders);
    expect_same_tables(set, *primitive.orders);
    expect_same_triangles(model.primitives[p].mesh, set, primitive.mesh, *primitive.orders);
    EXPECT_EQ(primitive.mesh.triangles, in_order(model.primitives[p].mesh, set.base_sequence));
    EXPECT_EQ(primitive.mesh.positions, model.primitives[p].mesh.positions);
    EXPECT_EQ(primitive.orders->base_sequence, identity(set.base_sequence.size()));
    const bool patches = GetParam().encoding != OrderEncoding::indices;
    EXPECT_EQ(primitive.orders->patch_offsets, patches ? set.patch_offsets : std::vector<std::uint32_t>{});
    again.push_back({p, *primitive.orders, {}});
  }
  EXPECT_TRUE(first.primitives[1].deforms);

  // Once more: the same bytes.
  fs::create_directory(folder_ / "second");
  write_model(first, again, path("second/a"), options());
  for (const std::string& file : report.files) {
    EXPECT_EQ(file_text(file), file_text(folder_ / ("second/" + fs::path(file).filename().string()))) << file;
  }
}

TEST_P(EveryOverdrawForm, SharesTablesBetweenPrimitives) {
  Random random(9);
  const Model model = read_model(moving_pyramids().save(folder_ / "plain.glb"));
  const std::vector<OrderedPrimitive> entries = orders(random, model);
  write_model(model, entries, path("a"), options());
  const Json json = json_of(path("a"));
  const Json& a = extension_of(json, 0);
  const Json& b = extension_of(json, 1);
  EXPECT_EQ(a["cellOrders"], b["cellOrders"]);
  EXPECT_EQ(a["keyframes"], b["keyframes"]);
  EXPECT_NE(a["orders"], b["orders"]);
  EXPECT_EQ(a["purpose"], "overdraw");
  EXPECT_EQ(a["sorting"], "frontToBack");
  EXPECT_EQ(a["keyframes"][0]["animation"], 1);
  const Json& spheres = json["accessors"][a["keyframes"][0]["spheres"].get<std::size_t>()];
  EXPECT_EQ(spheres["type"], "VEC4");
  EXPECT_EQ(spheres["count"], 4);
}

TEST_P(EveryOverdrawForm, IsRemovedWithoutATrace) {
  Random random(11);
  const std::string original = moving_pyramids().save(path("plain"));
  write_model(read_model(original), {}, path("passed"));
  const Model model = read_model(original);
  std::vector<OrderedPrimitive> entries = orders(random, model);
  // Orders of the indices as they are; those of both primitives are one accessor, so that they stay shared.
  for (OrderedPrimitive& entry : entries) {
    entry.orders.base_sequence = identity(6);
    entry.orders.patch_offsets = {0, 2, 3, 6};
    entry.orders.orders.assign(4, {4, 0, 2, 6, 8, 10});
  }
  write_model(model, entries, path("ordered"), options());
  // One primitive's alone, then none.
  write_model(read_model(path("ordered")), {entries[1]}, path("less"), options());
  EXPECT_FALSE(read_model(path("less")).primitives[0].orders);
  EXPECT_TRUE(read_model(path("less")).primitives[1].orders);
  for (const char* from : {"ordered", "less"}) {
    write_model(read_model(path(from)), {}, path("stripped"));
    Json expected = json_of(path("passed"));
    Json stripped = json_of(path("stripped"));
    for (Json* json : {&expected, &stripped}) (*json)["buffers"][0].erase("uri");
    EXPECT_EQ(stripped, expected) << from;
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryOverdrawForm, ::testing::ValuesIn(all_overdraw_forms()));

// -------------------------------------------------------------------------------------------- validator

// Files for scripts/validate-gltf, beside those of the other tests.
TEST(ValidatorFiles, OverdrawFormsAreWritten) {
  const TempFolder temporary;
  const char* asked = std::getenv("PELLUCID_VALIDATOR_FILES");
  const std::string folder = asked != nullptr ? asked : temporary / "files";
  fs::create_directories(folder);
  Random random(47);
  const Model model = read_model(moving_pyramids().save(temporary / "moving.glb"));
  int number = 0;
  for (const OverdrawForm& form : all_overdraw_forms()) {
    std::vector<OrderedPrimitive> entries;
    for (std::uint32_t p = 0; p < 2; ++p) {
      entries.push_back(
          {p,
           random_overdraw_orders(random, model.primitives[p].mesh, parse_partition(form.cells), 3, {0, 1}),
           {}});
    }
    WriteOptions options;
    options.encoding = form.encoding;
    options.split_buffer = form.split;
    const std::string path = folder + "/overdraw-" + std::to_string(number++) + form.extension;
    write_model(model, entries, path, options);
    EXPECT_TRUE(read_model(path).primitives[1].orders);
  }
}

// ------------------------------------------------------------------------------------------ special forms

TEST(OverdrawOrders, WritesTheBaseOfPatchesEvenWhereItIsNotAskedFor) {
  const TempFolder folder;
  Random random(13);
  const Mesh mesh = random_mesh(random, 30, 40);
  OrderSet set = random_overdraw_orders(random, mesh, {}, 3, {});
  for (const bool own : {false, true}) {
    const Model model = own ? model_of(mesh) : read_model([&] {
      write_model(model_of(mesh), {}, folder / "plain.glb");
      return folder / "plain.glb";
    }());
    WriteOptions options;
    options.bake_base = false;
    write_model(model, {{0, set, {}}}, folder / "indices.glb", options);
    const Primitive kept = read_model(folder / "indices.glb").primitives[0];
    EXPECT_EQ(kept.mesh.triangles, mesh.triangles);
    expect_same_triangles(mesh, set, kept.mesh, *kept.orders);
    options.encoding = OrderEncoding::patches;
    options.direction = SortDirection::back_to_front;  // not a thing of overdraw orders
    write_model(model, {{0, set, {}}}, folder / "patches.glb", options);
    const Primitive baked = read_model(folder / "patches.glb").primitives[0];
    EXPECT_EQ(baked.mesh.triangles, in_order(mesh, set.base_sequence));
    EXPECT_EQ(baked.orders->patch_offsets, set.patch_offsets);
    expect_same_triangles(mesh, set, baked.mesh, *baked.orders);
  }
}

TEST(OverdrawOrders, StoresIndicesWhereTheTrianglesMustStay) {
  const TempFolder folder;
  HandMade file = pyramid();
  file.primitive()["extensions"]["EXT_mesh_primitive_edge_visibility"] = {{"visibility", 0}};
  const Model model = read_model(file.save(folder / "a.glb"));
  Random random(17);
  const OrderSet set = random_overdraw_orders(random, model.primitives[0].mesh, {}, 2, {});
  write_model(model, {{0, set, {}}}, folder / "b.glb", {.encoding = OrderEncoding::meshopt});
  const Json json = json_of(folder / "b.glb");
  EXPECT_TRUE(extension_of(json, 0)["orders"][0].contains("indices"));
  EXPECT_FALSE(extension_of(json, 0).contains("patchOffsets"));
  const Primitive written = read_model(folder / "b.glb").primitives[0];
  EXPECT_EQ(written.mesh.triangles, model.primitives[0].mesh.triangles);
  expect_same_triangles(model.primitives[0].mesh, set, written.mesh, *written.orders);
}

TEST(OverdrawOrders, LeaveOutWhatTheBaseLeavesOut) {
  const TempFolder folder;
  const Model model = read_model(pyramid().save(folder / "a.glb"));
  Random random(19);
  OrderSet set = random_overdraw_orders(random, model.primitives[0].mesh, {}, 2, {});
  set.base_sequence = {5, 1, 3, 0};
  set.orders = {{10, 2, 6, 0}, {6, 0, 10, 2}};
  for (const OrderEncoding encoding : {OrderEncoding::indices, OrderEncoding::patches}) {
    for (const std::vector<std::uint32_t>& offsets : {std::vector<std::uint32_t>{0, 2, 4}, {}}) {
      set.patch_offsets = offsets;
      write_model(model, {{0, set, {}}}, folder / "b.glb", {.encoding = encoding});
      const Primitive written = read_model(folder / "b.glb").primitives[0];
      EXPECT_EQ(written.mesh.triangles, in_order(model.primitives[0].mesh, {5, 1, 3, 0, 2, 4}));
      EXPECT_EQ(written.orders->base_sequence, identity(4));
      EXPECT_EQ(written.orders->orders[1], (NodeSequence{4, 6, 0, 2}));
      const bool patches = encoding == OrderEncoding::patches;
      EXPECT_EQ(written.orders->patch_offsets, patches ? offsets : std::vector<std::uint32_t>{});
    }
  }
}

// ----------------------------------------------------------------------------------------- bad extensions

// The accessor that a key of the extension names.
Json& accessor_of(Json& document, const Json& id) {
  return document["accessors"][id.get<std::size_t>()];
}

// Where an accessor's bytes begin, in the one buffer.
std::size_t offset_of(Json& document, const Json& id) {
  const Json& accessor = accessor_of(document, id);
  return document["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>() +
         accessor.value("byteOffset", std::size_t{0});
}

class BadOverdraw : public ::testing::TestWithParam<BadExtension> {};

// Damage to the bytes of the side file is asked for as {"poke": [[offset, byte], ...]} in the document.
TEST_P(BadOverdraw, IsRefusedNamingThePrimitive) {
  const TempFolder folder;
  Random random(41);
  const Model model = read_model(moving_pyramids().save(folder / "plain.gltf"));
  OrderSet set = random_overdraw_orders(random, model.primitives[0].mesh, parse_partition("S0,0"), 3, {0, 1});
  set.patch_offsets = {0, 2, 3, 6};
  set.base_sequence = identity(6);
  set.orders = {{0, 2, 4, 6, 8, 10}, {4, 0, 2, 6, 8, 10}, {6, 8, 10, 4, 0, 2}};
  WriteOptions options;
  const bool indices = std::string(GetParam().name).starts_with("Indices");
  options.encoding = indices ? OrderEncoding::indices : OrderEncoding::patches;
  write_model(model, {{0, set, {}}}, folder / "a.gltf", options);
  Json json = json_of(folder / "a.gltf");
  GetParam().damage(json["meshes"][0]["primitives"][0]["extensions"]["PELLUCID_mesh_primitive_view_orders"],
                    json);
  if (json.contains("poke")) {
    Bytes bytes = read_file(folder / "a.bin");
    for (const Json& poke : json["poke"]) {
      bytes.at(poke[0].get<std::size_t>()) = static_cast<std::byte>(poke[1].get<int>());
    }
    write_file_atomically(folder / "a.bin", bytes);
    json.erase("poke");
  }
  write_file_atomically(folder / "a.gltf", json.dump());
  const std::string message = error_of([&] { read_model(folder / "a.gltf"); });
  EXPECT_THAT(message, ::testing::HasSubstr("a.gltf: "));
  EXPECT_THAT(message, ::testing::HasSubstr(GetParam().message));
}

void poke(Json& document, const Json& id, std::size_t byte, int value) {
  document["poke"].push_back({offset_of(document, id) + byte, value});
}

// A little-endian float in the place of element `i`.
void poke_float(Json& document, const Json& id, std::size_t i, float value) {
  std::array<unsigned char, 4> bytes{};
  std::memcpy(bytes.data(), &value, 4);
  for (std::size_t k = 0; k < 4; ++k) poke(document, id, 4 * i + k, bytes[k]);
}

INSTANTIATE_TEST_SUITE_P(
    All, BadOverdraw,
    ::testing::Values(
        BadExtension{"Purpose", [](Json& e, Json&) { e["purpose"] = "speed"; }, "purpose 'speed'"},
        BadExtension{"Transparency", [](Json& e, Json&) { e.erase("purpose"); }, "only overdraw orders"},
        BadExtension{"TransparencyRanks",
                     [](Json& e, Json&) {
                       e.erase("purpose");
                       e.erase("keyframes");
                     },
                     "only overdraw orders have a rank"},
        BadExtension{"Sorting", [](Json& e, Json&) { e["sorting"] = "backToFront"; }, "frontToBack"},
        BadExtension{"Facing", [](Json& e, Json&) { e["facing"] = "duplicated"; }, "must be single"},
        BadExtension{"RankMissing", [](Json& e, Json&) { e["orders"][1].erase("rank"); }, "have none"},
        BadExtension{"RankLarge", [](Json& e, Json&) { e["orders"][1]["rank"] = 1ULL << 32U; }, "2^32"},
        BadExtension{"RankNegative", [](Json& e, Json&) { e["orders"][1]["rank"] = -1; }, "rank"},
        BadExtension{"FewerTriangles",
                     [](Json& e, Json& d) { accessor_of(d, e["orders"][1]["patches"])["count"] = 2; },
                     "orders[1] does not draw every triangle once"},
        BadExtension{"NothingDrawn", [](Json& e, Json&) { e["orders"][0].erase("patches"); },
                     "orders[0] does not draw"},
        BadExtension{"PatchTwice", [](Json& e, Json& d) { poke(d, e["orders"][0]["patches"], 0, 1); },
                     "comes twice"},
        BadExtension{"PatchFlipped", [](Json& e, Json& d) { poke(d, e["orders"][0]["patches"], 0, 3); },
                     "out of range"},
        BadExtension{"OffsetsFromOne", [](Json& e, Json& d) { poke(d, e["patchOffsets"], 0, 1); },
                     "rise strictly"},
        BadExtension{"OffsetsRepeat", [](Json& e, Json& d) { poke(d, e["patchOffsets"], 1, 3); },
                     "rise strictly"},
        BadExtension{"OffsetsTooFar", [](Json& e, Json& d) { poke(d, e["patchOffsets"], 3, 7); },
                     "rise strictly"},
        BadExtension{"OffsetsShort", [](Json& e, Json& d) { accessor_of(d, e["patchOffsets"])["count"] = 3; },
                     "out of range"},
        BadExtension{"IndicesMissATriangle",
                     [](Json& e, Json& d) { accessor_of(d, e["orders"][2]["indices"])["count"] = 15; },
                     "orders[2] does not draw every triangle once"},
        BadExtension{"IndicesTwice",
                     [](Json& e, Json& d) {
                       const Json& id = e["orders"][0]["indices"];
                       const std::array<int, 3> second{1, 3, 2};
                       for (std::size_t k = 0; k < 3; ++k) poke(d, id, 2 * k, second[k]);
                     },
                     "comes too often"},
        BadExtension{"Animation", [](Json& e, Json&) { e["keyframes"][0]["animation"] = 2; },
                     "animation 2 does not exist"},
        BadExtension{"AnimationTwice", [](Json& e, Json&) { e["keyframes"][1]["animation"] = 0; },
                     "animation 0 has two tables"},
        BadExtension{"AnimationMissing", [](Json& e, Json&) { e["keyframes"][1].erase("animation"); },
                     "animation is missing"},
        BadExtension{"NoTimes", [](Json& e, Json&) { e["keyframes"][0].erase("times"); }, "times is missing"},
        BadExtension{"TimesAreSpheres",
                     [](Json& e, Json&) { e["keyframes"][0]["times"] = e["keyframes"][0]["spheres"]; },
                     "type is VEC4, not SCALAR"},
        BadExtension{"TimesAreIntegers", [](Json& e, Json&) { e["keyframes"][0]["times"] = e["cellOrders"]; },
                     "does not hold floats"},
        BadExtension{"TimesNowhere", [](Json& e, Json&) { e["keyframes"][0]["times"] = 9999; }, "9999"},
        BadExtension{"TimesEqual", [](Json& e, Json& d) { poke_float(d, e["keyframes"][0]["times"], 1, 0); },
                     "strictly increasing"},
        BadExtension{"TimesNaN", [](Json& e, Json& d) { poke_float(d, e["keyframes"][0]["times"], 0, NAN); },
                     "not finite"},
        BadExtension{"TimesInfinite",
                     [](Json& e, Json& d) { poke_float(d, e["keyframes"][0]["times"], 2, INFINITY); },
                     "not finite"},
        BadExtension{"TimesMore",
                     [](Json& e, Json&) { e["keyframes"][0]["times"] = e["keyframes"][1]["times"]; },
                     "3 spheres for 4 times"},
        BadExtension{
            "TimesHuge",
            [](Json& e, Json& d) { accessor_of(d, e["keyframes"][0]["times"])["count"] = 1ULL << 60U; },
            "asks for"},
        BadExtension{"SphereNaN",
                     [](Json& e, Json& d) { poke_float(d, e["keyframes"][0]["spheres"], 5, NAN); },
                     "spheres[1] is not finite"},
        BadExtension{"SphereNegative",
                     [](Json& e, Json& d) { poke_float(d, e["keyframes"][0]["spheres"], 11, -1); },
                     "spheres[2] is not finite, or its radius"},
        BadExtension{"CellsOfRest", [](Json& e, Json&) { e["keyframes"][0]["cellOrders"] = e["cellOrders"]; },
                     "the partition needs 60"},
        BadExtension{"CellsOutOfRange",
                     [](Json& e, Json& d) { poke(d, e["keyframes"][0]["cellOrders"], 59, 3); },
                     "cellOrders[59] names order 3 of 3"},
        BadExtension{"KeyframesAreNumbers", [](Json& e, Json&) { e["keyframes"] = {1, 2}; }, "keyframes"},
        BadExtension{"KeyframesAreNoArray", [](Json& e, Json&) { e["keyframes"] = "soon"; }, "keyframes"}),
    [](const auto& bad_case) { return bad_case.param.name; });

// ---------------------------------------------------------------------------------------- bad arguments

TEST(BadOverdrawArguments, AreRefusedBeforeAnythingIsWritten) {
  const TempFolder folder;
  Random random(43);
  const Model model = read_model(moving_pyramids().save(folder / "plain.glb"));
  OrderSet good =
      random_overdraw_orders(random, model.primitives[0].mesh, parse_partition("S0,0"), 2, {0, 1});
  good.patch_offsets = {0, 2, 6};
  good.base_sequence = identity(6);
  good.orders = {{0, 2, 4, 6, 8, 10}, {4, 6, 8, 10, 0, 2}};
  const auto refusal = [&](const std::function<void(OrderSet&)>& damage) {
    OrderSet set = good;
    damage(set);
    std::string message = error_of(
        [&] {
          write_model(model, {{0, set, {}}}, folder / "a.glb");
        },
        ErrorKind::bad_argument);
    EXPECT_FALSE(fs::exists(folder / "a.glb"));
    return message;
  };
  using ::testing::HasSubstr;
  using Numbers = std::vector<std::uint32_t>;
  EXPECT_THAT(refusal([](OrderSet& s) { s.purpose = OrderPurpose::transparency; }), HasSubstr("overdraw"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.facing = Facing::duplicated; }), HasSubstr("facing is single"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.model_ranks.pop_back(); }), HasSubstr("1 model ranks for 2"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.orders[0].pop_back(); }), HasSubstr("every triangle"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.base_sequence.pop_back(); }), HasSubstr("every triangle"));
  const char* const rise = "rise strictly";
  EXPECT_THAT(refusal([](OrderSet& s) { s.patch_offsets = Numbers{0}; }), HasSubstr(rise));
  EXPECT_THAT(refusal([](OrderSet& s) { s.patch_offsets = Numbers{1, 6}; }), HasSubstr(rise));
  EXPECT_THAT(refusal([](OrderSet& s) { s.patch_offsets = Numbers{0, 2, 2, 6}; }), HasSubstr(rise));
  EXPECT_THAT(refusal([](OrderSet& s) { s.patch_offsets = Numbers{0, 2, 7}; }), HasSubstr(rise));
  EXPECT_THAT(refusal([](OrderSet& s) { s.patch_offsets = Numbers{0, 3, 6}; }), HasSubstr("whole patches"));
  EXPECT_THAT(refusal([](OrderSet& s) { std::swap(s.orders[0][0], s.orders[0][1]); }),
              HasSubstr("whole patches"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[1].animation = 2; }), HasSubstr("no such animation"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[1].animation = 0; }), HasSubstr("two tables"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[0].times[0] = NAN; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[0].times[1] = 1e-60; }),
              HasSubstr("strictly increasing"));  // as 32-bit floats
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[0].times.clear(); }),
              HasSubstr("0 times and 3 spheres"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[0].spheres[1].radius = -1; }), HasSubstr("a sphere"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[0].spheres[1].center.y = 1e300; }),
              HasSubstr("a sphere"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[0].cell_orders.pop_back(); }), HasSubstr("59 cells"));
  EXPECT_THAT(refusal([](OrderSet& s) { s.animations[0].cell_orders[50] = 2; }), HasSubstr("names order 2"));
}

}  // namespace
}  // namespace pellucid::test
