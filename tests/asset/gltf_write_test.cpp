// Tests writing of glTF: nothing in a file is lost, models of other formats become valid documents, and
// failures leave no files behind.
#include <sys/stat.h>
#include <unistd.h>

#include "gltf_helpers.h"

namespace pellucid::test {
namespace {

Bytes binary_chunk(const std::string& path) {
  const Bytes file = read_file(path);
  std::uint32_t json_length = 0;
  std::memcpy(&json_length, file.data() + 12, 4);
  const std::size_t at = 20 + json_length;
  if (file.size() < at + 8) return {};
  std::uint32_t length = 0;
  std::memcpy(&length, file.data() + at, 4);
  return {file.begin() + static_cast<std::ptrdiff_t>(at + 8),
          file.begin() + static_cast<std::ptrdiff_t>(at + 8 + length)};
}

TEST(PassThrough, RealFilesLoseNothing) {
  if (!fs::is_directory(PELLUCID_MODELS)) GTEST_SKIP() << "development model missing: " << PELLUCID_MODELS;
  const TempFolder folder;
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(PELLUCID_MODELS)) {
    if (entry.path().extension() != ".glb") continue;
    ++files;
    const std::string source = entry.path().string();
    const Model model = read_model(source);
    write_model(model, {}, folder / "out.glb");
    EXPECT_EQ(json_of(folder / "out.glb"), json_of(source)) << source;
    EXPECT_EQ(binary_chunk(folder / "out.glb"), binary_chunk(source)) << source;
    write_model(read_model(folder / "out.glb"), {}, folder / "again.glb");
    EXPECT_EQ(file_text(folder / "again.glb"), file_text(folder / "out.glb")) << source;
  }
  EXPECT_GE(files, 1);
}

TEST(PassThrough, RealFilesTakeOrdersAndLoseThemAgain) {
  const std::string source = std::string(PELLUCID_MODELS) + "/scenes/fusion_shells.glb";
  if (!fs::exists(source)) GTEST_SKIP() << "development model missing: " << source;
  const TempFolder folder;
  const Model model = read_model(source);
  Random random(1);
  std::vector<OrderedPrimitive> ordered;
  for (std::uint32_t p = 0; p < model.primitives.size(); ++p) {
    const Mesh& mesh = model.primitives[p].mesh;
    OrderSet set = random_orders(random, mesh, {}, 4, Facing::duplicated);
    std::iota(set.base_sequence.begin(), set.base_sequence.end(), 0U);
    ordered.push_back({p, std::move(set), {}});
  }
  write_model(model, ordered, folder / "ordered.glb");
  const Model read = read_model(folder / "ordered.glb");
  for (const OrderedPrimitive& entry : ordered) {
    const Primitive& primitive = read.primitives[entry.primitive];
    ASSERT_TRUE(primitive.orders);
    for (std::size_t i = 0; i < entry.orders.orders.size(); ++i) {
      ASSERT_EQ(drawn(primitive.mesh, primitive.orders->orders[i]),
                drawn(primitive.mesh, entry.orders.orders[i]));
    }
  }
  write_model(read, {}, folder / "stripped.glb");
  EXPECT_EQ(json_of(folder / "stripped.glb"), json_of(source));
  EXPECT_EQ(binary_chunk(folder / "stripped.glb"), binary_chunk(source));
}

TEST(PassThrough, OtherChunksAndForeignDataStay) {
  const TempFolder folder;
  HandMade file = pyramid();
  file.json["extras"] =
      Json::parse(R"({"z":1,"a":null,"float":0.1,"exp":1e-30,"int":9007199254740993,"neg":-5})");
  const std::string source = file.save(folder / "a.glb");
  Bytes bytes = read_file(source);
  put_u32(bytes, 4);
  put_u32(bytes, 0x58585858);
  put_u32(bytes, 0x12345678);
  const auto total = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(bytes.data() + 8, &total, 4);
  write_file_atomically(source, bytes);
  write_model(read_model(source), {}, folder / "b.glb");
  EXPECT_EQ(read_file(folder / "b.glb"), bytes);
}

// Foreign data may use glTF's own words for anything: numbers that are no indices refer to nothing.
TEST(PassThrough, ForeignNumbersThatAreNoIndicesStay) {
  const TempFolder folder;
  HandMade file = pyramid();
  file.json["extras"] = Json::parse(R"([{"bufferView":1e38},{"bufferView":-1},{"bufferView":0.5}])");
  const Model model = read_model(file.save(folder / "a.glb"));
  Random random(1);
  OrderSet set = random_orders(random, model.primitives[0].mesh, {}, 2, Facing::duplicated);
  std::iota(set.base_sequence.begin(), set.base_sequence.end(), 0U);
  write_model(model, {{0, std::move(set), {}}}, folder / "ordered.glb");
  write_model(read_model(folder / "ordered.glb"), {}, folder / "stripped.glb");
  EXPECT_EQ(json_of(folder / "stripped.glb"), json_of(folder / "a.glb"));
}

TEST(Conversion, ConvertsBetweenGlbAndGltf) {
  const TempFolder folder;
  fs::create_directory(folder / "other place");
  const Model glb = read_model(pyramid().save(folder / "a.glb"));
  write_model(glb, {}, folder / "other place/b #1.gltf");
  EXPECT_EQ(json_of(folder / "other place/b #1.gltf")["buffers"][0]["uri"], "b%20%231.bin");
  const Model gltf = read_model(folder / "other place/b #1.gltf");
  EXPECT_EQ(gltf.primitives[0].mesh.triangles, glb.primitives[0].mesh.triangles);
  write_model(gltf, {}, folder / "c.glb");
  EXPECT_EQ(file_text(folder / "c.glb"), file_text(folder / "a.glb"));
  // Beside the original nothing moves.
  write_model(gltf, {}, folder / "other place/d.gltf");
  EXPECT_EQ(json_of(folder / "other place/d.gltf"), json_of(folder / "other place/b #1.gltf"));
  EXPECT_FALSE(fs::exists(folder / "other place/d.bin"));
}

TEST(Minimal, NotFiniteVerticesAndTheirTrianglesStayOut) {
  const TempFolder folder;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 2}, {0, 0, 0}, {NAN, 0, 0}};
  mesh.triangles = {{0, 1, 3}, {0, 1, 2}};
  Random random(2);
  OrderSet set = random_orders(random, mesh, {}, 2, Facing::duplicated);
  set.orders = {{2, 3}, {3}};
  for (const OrderEncoding encoding : {OrderEncoding::indices, OrderEncoding::patches}) {
    write_model(model_of(mesh), {{0, set, {}}}, folder / "a.glb", {.encoding = encoding});
    const Primitive primitive = read_model(folder / "a.glb").primitives[0];
    EXPECT_EQ(primitive.mesh.triangles, std::vector<Triangle>({{0, 1, 2}}));
    EXPECT_EQ(primitive.mesh.positions[3], (Vec3f{0, 0, 0}));
    EXPECT_EQ(primitive.mesh.normals[1], (Vec3f{0, 0, 1}));
    EXPECT_EQ(primitive.orders->orders, (std::vector<NodeSequence>{{0, 1}, {1}}));
  }
}

TEST(Minimal, InstancesMaterialsAndNamesInAnyEncoding) {
  const TempFolder folder;
  Random random(4);
  Model model = model_of(random_mesh(random, 8, 5));
  model.primitives[0].name = "caf\xE9";  // Latin-1, as old OBJ files have it
  Instance moved = model.instances[0];
  moved.world.m[12] = 3;
  model.instances.push_back(moved);
  write_model(model, {}, folder / "a.gltf");
  const Model read = read_model(folder / "a.gltf");
  ASSERT_EQ(read.instances.size(), 2U);
  EXPECT_EQ(read.instances[1].world.m[12], 3);
  EXPECT_EQ(read.primitives[0].alpha_mode, AlphaMode::blend);
  EXPECT_EQ(read.primitives[0].base_color, (std::array{0.2F, 0.4F, 0.8F, 0.5F}));
  EXPECT_TRUE(read.primitives[0].double_sided);
}

TEST(Minimal, NoGeometryIsNothingToDo) {
  const TempFolder folder;
  EXPECT_THAT(error_of([&] { write_model(model_of({}), {}, folder / "a.glb"); }, ErrorKind::nothing_to_do),
              ::testing::HasSubstr("no geometry"));
}

// ------------------------------------------------------------------------------ textures beside the model

// A pyramid in a folder of its own, with these images beside it.
class TexturesBeside : public ::testing::Test {
 protected:
  TexturesBeside() {
    for (const char* name : {"in", "in/model", "in/model/tex", "out"}) fs::create_directory(folder_ / name);
    write("in/model/tex/pane one.png", "\x89PNG one");
    write("in/shared.png", "\x89PNG shared");
    HandMade file = pyramid();
    file.json["images"] =
        Json::array({{{"uri", "tex/pane%20one.png"}}, {{"uri", "../shared.png"}}, {{"uri", "none.png"}}});
    model_ = read_model(file.save(folder_ / "in/model/a.gltf"));
  }
  void write(const std::string& name, const std::string& text) {
    Bytes bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    write_file_atomically(folder_ / name, bytes);
  }
  WriteReport written(const std::string& name, bool embed = false) {
    WriteOptions options;
    options.embed_textures = embed;
    return write_model(model_, {}, folder_ / name, options);
  }
  static Json images_of(const std::string& path) {
    const std::string text = file_text(path);
    return path.ends_with(".glb") ? json_of(path)["images"] : Json::parse(text)["images"];
  }

  TempFolder folder_;
  Model model_;
};

TEST_F(TexturesBeside, FollowAGltfIntoAnotherFolder) {
  const WriteReport report = written("out/a.gltf");
  EXPECT_EQ(file_text(folder_ / "out/tex/pane one.png"), "\x89PNG one");
  EXPECT_EQ(file_text(folder_ / "out/shared.png"), "\x89PNG shared") << "never outside of the folder";
  const Json images = images_of(folder_ / "out/a.gltf");
  EXPECT_EQ(images[0]["uri"], "tex/pane%20one.png");
  EXPECT_EQ(images[1]["uri"], "shared.png");
  EXPECT_THAT(report.notes, ::testing::ElementsAre(::testing::HasSubstr("'none.png' is missing")));
  EXPECT_THAT(report.files, ::testing::Contains(folder_ / "out/tex/pane one.png"));
  // The same again changes nothing.
  written("out/a.gltf");
  EXPECT_EQ(images_of(folder_ / "out/a.gltf"), images);
}

TEST_F(TexturesBeside, NeverReplaceAFileWithOtherContent) {
  write("out/shared.png", "mine");
  written("out/a.gltf");
  EXPECT_EQ(file_text(folder_ / "out/shared.png"), "mine");
  EXPECT_EQ(file_text(folder_ / "out/shared-2.png"), "\x89PNG shared");
  EXPECT_EQ(images_of(folder_ / "out/a.gltf")[1]["uri"], "shared-2.png");
}

TEST_F(TexturesBeside, BecomePartOfAGlbAndOfAnyFileOnRequest) {
  for (const auto& [name, embed] :
       {std::pair{"out/a.glb", false}, {"out/b.gltf", true}, {"in/model/c.glb", true}}) {
    written(name, embed);
    const Json images = images_of(folder_ / name);
    for (const std::size_t i : {0U, 1U}) {
      EXPECT_FALSE(images[i].contains("uri")) << name;
      EXPECT_EQ(images[i]["mimeType"], "image/png") << name;
      EXPECT_TRUE(images[i].contains("bufferView")) << name;
    }
  }
  EXPECT_FALSE(fs::exists(folder_ / "out/tex"));
}

TEST_F(TexturesBeside, StayWhereTheyAreBesideTheSource) {
  written("in/model/b.gltf");
  EXPECT_EQ(images_of(folder_ / "in/model/b.gltf")[1]["uri"], "../shared.png");
}

TEST(SideFiles, OfAnEarlierRunAreNamed) {
  const TempFolder folder;
  const Model model = read_model(pyramid().save(folder / "a.glb"));
  Random random(6);
  const OrderSet set = random_orders(random, model.primitives[0].mesh, {}, 2, Facing::duplicated);
  WriteOptions options;
  options.split_buffer = true;
  EXPECT_TRUE(write_model(model, {{0, set, {}}}, folder / "b.glb", options).notes.empty());
  options.split_buffer = false;
  EXPECT_THAT(write_model(model, {{0, set, {}}}, folder / "b.glb", options).notes,
              ::testing::ElementsAre(::testing::HasSubstr("b.orders.bin is of an earlier run")));
}

// ------------------------------------------------------------------------------------------------ failures

TEST(CannotWrite, SaysWhyAndLeavesNothing) {
  const TempFolder folder;
  const Model model = read_model(pyramid().save(folder / "a.glb"));
  Random random(6);
  const OrderSet set = random_orders(random, model.primitives[0].mesh, {}, 2, Facing::duplicated);
  WriteOptions split;
  split.split_buffer = true;
  const auto refusal = [&](const std::string& path) {
    return error_of([&] { write_model(model, {{0, set, {}}}, path, split); }, ErrorKind::cannot_write);
  };
  EXPECT_THAT(refusal(folder / "missing/b.glb"), ::testing::HasSubstr("missing/b.orders.bin: cannot write"));

  fs::create_directory(folder / "dir.glb");
  EXPECT_THAT(refusal(folder / "dir.glb"), ::testing::HasSubstr("directory"));
  EXPECT_FALSE(fs::exists(folder / "dir.orders.bin")) << "side files go when the main file fails";

  fs::create_symlink("/dev/full", folder / "full.glb");
  EXPECT_THAT(refusal(folder / "full.glb"), ::testing::HasSubstr("No space left"));
  EXPECT_FALSE(fs::exists(folder / "full.orders.bin"));

  if (::geteuid() == 0) return;  // root may write anywhere
  fs::create_directory(folder / "locked");
  ::chmod((folder / "locked").c_str(), 0555);
  EXPECT_THAT(refusal(folder / "locked/b.glb"), ::testing::HasSubstr("Permission denied"));
  ::chmod((folder / "locked").c_str(), 0755);
}

// ------------------------------------------------------------------------------------------------- hostile

// Flip, cut, repeat: the reader either refuses with an Error or returns a model that the writer can handle.
TEST(Hostile, MutatedFilesNeverCrash) {
  const TempFolder folder;
  Random random(99);
  const Mesh mesh = random_mesh(random, 12, 10);
  std::vector<Bytes> seeds;
  for (const OrderEncoding encoding :
       {OrderEncoding::indices, OrderEncoding::patches, OrderEncoding::meshopt}) {
    for (const char* name : {"seed.glb", "seed.gltf"}) {
      const auto kind = seeds.size() % 2 == 0 ? PartitionKind::viewpoints : PartitionKind::sampled_triangles;
      const OrderSet set = random_orders(random, mesh, {kind, 0, 0}, 2, Facing::duplicated);
      write_model(model_of(mesh), {{0, set, OrderErrorRecord{}}}, folder / name, {.encoding = encoding});
      seeds.push_back(read_file(folder / name));
    }
  }
  ReadOptions options;
  options.max_elements = 1U << 20U;
  int refused = 0;
  for (int round = 0; round < 4000; ++round) {
    Bytes bytes = seeds[static_cast<std::size_t>(round) % seeds.size()];
    const std::uint64_t changes = 1 + random.below(4);
    for (std::uint64_t i = 0; i < changes; ++i) {
      const std::size_t at = random.below(bytes.size());
      switch (random.below(6)) {
        case 0:
          bytes[at] ^= static_cast<std::byte>(1U << random.below(8));
          break;
        case 1:
          bytes[at] = static_cast<std::byte>(random.below(256));
          break;
        case 2:
          bytes[at] = static_cast<std::byte>('0' + random.below(10));
          break;
        case 3:
          bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
          break;
        case 4:
          bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), static_cast<std::byte>('9'));
          break;
        default:
          if (random.below(8) == 0) bytes.resize(at + 1);
      }
    }
    const std::string path = folder / (round % 2 == 0 ? "seed.glb" : "seed.gltf");
    write_file_atomically(path, bytes);
    try {
      const Model model = read_model(path, options);
      std::vector<OrderedPrimitive> ordered;
      for (std::uint32_t p = 0; p < model.primitives.size(); ++p) {
        if (model.primitives[p].orders) ordered.push_back({p, *model.primitives[p].orders, {}});
      }
      write_model(model, ordered, folder / "out.glb");
    } catch (const Error& error) {
      ++refused;
      EXPECT_NE(error.kind(), ErrorKind::internal) << error.what();
    }
  }
  EXPECT_GT(refused, 400);
  EXPECT_LT(refused, 4000);
}

}  // namespace
}  // namespace pellucid::test
