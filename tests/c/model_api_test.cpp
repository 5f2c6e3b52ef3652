// Tests the C interface with files: read, order, write, read again.
#include <filesystem>
#include <fstream>
#include <string>

#include "api_helpers.h"

namespace pellucid {
namespace {

using testing::Arrays;
using ::testing::HasSubstr;
using testing::indices_of;
using testing::ModelHandle;
using testing::ordered;
using testing::OrderSetHandle;
using testing::quick_options;
using testing::torus;

// Returns a path that only this test uses.
std::string file_named(const std::string& name) {
  const ::testing::TestInfo& test = *::testing::UnitTest::GetInstance()->current_test_info();
  const auto folder = std::filesystem::path(::testing::TempDir()) / "pellucid_c_api" / test.name();
  std::filesystem::create_directories(folder);
  return (folder / name).string();
}

std::string write_off(const Arrays& arrays) {
  const std::string path = file_named("torus.off");
  std::ofstream file(path);
  file.precision(9);
  file << "OFF\n" << arrays.positions.size() / 3 << ' ' << arrays.indices.size() / 3 << " 0\n";
  for (std::size_t i = 0; i < arrays.positions.size(); i += 3)
    file << arrays.positions[i] << ' ' << arrays.positions[i + 1] << ' ' << arrays.positions[i + 2] << '\n';
  for (std::size_t i = 0; i < arrays.indices.size(); i += 3)
    file << "3 " << arrays.indices[i] << ' ' << arrays.indices[i + 1] << ' ' << arrays.indices[i + 2] << '\n';
  return path;
}

ModelHandle read(const std::string& path) {
  PellucidModel* model = nullptr;
  EXPECT_EQ(pellucid_read_model(path.c_str(), &model), pellucid_ok) << pellucid_last_error();
  return ModelHandle(model);
}

PellucidPrimitive primitive_of(const ModelHandle& model) {
  PellucidPrimitive primitive{};
  EXPECT_EQ(pellucid_model_primitive(model.get(), 0, &primitive, sizeof primitive), pellucid_ok);
  return primitive;
}

TEST(CModel, OrdersSurviveTheFile) {
  const Arrays arrays = torus();
  const ModelHandle model = read(write_off(arrays));
  ASSERT_EQ(pellucid_primitive_count(model.get()), 1U);
  const PellucidPrimitive primitive = primitive_of(model);
  EXPECT_EQ(primitive.mesh.triangle_count, arrays.indices.size() / 3);
  EXPECT_EQ(primitive.double_sided, 1U);
  EXPECT_EQ(primitive.has_orders, 0U);

  const OrderSetHandle made = ordered(primitive.mesh, quick_options());
  ASSERT_EQ(pellucid_model_set_orders(model.get(), 0, made.get()), pellucid_ok) << pellucid_last_error();
  PellucidWriteOptions options;
  pellucid_write_options_init(&options, sizeof options);
  options.encoding = pellucid_encoding_patches;
  options.keep_indices = 1;
  const std::string written = file_named("torus.glb");
  ASSERT_EQ(pellucid_write_model(model.get(), written.c_str(), &options), pellucid_ok)
      << pellucid_last_error();

  const ModelHandle again = read(written);
  EXPECT_EQ(primitive_of(again).has_orders, 1U);
  PellucidOrderSet* raw = nullptr;
  ASSERT_EQ(pellucid_model_orders(again.get(), 0, &raw), pellucid_ok);
  const OrderSetHandle stored(raw);
  ASSERT_EQ(pellucid_order_count(stored.get()), pellucid_order_count(made.get()));
  for (std::uint32_t order = 0; order < pellucid_order_count(made.get()); ++order)
    EXPECT_EQ(indices_of(stored.get(), order), indices_of(made.get(), order));
}

TEST(CModel, OrdersCanBeTakenAway) {
  const ModelHandle model = read(write_off(torus()));
  const OrderSetHandle made = ordered(primitive_of(model).mesh, quick_options());
  ASSERT_EQ(pellucid_model_set_orders(model.get(), 0, made.get()), pellucid_ok);
  ASSERT_EQ(pellucid_model_set_orders(model.get(), 0, nullptr), pellucid_ok);
  PellucidOrderSet* none = nullptr;
  EXPECT_EQ(pellucid_model_orders(model.get(), 0, &none), pellucid_nothing_to_do);
  const std::string written = file_named("plain.glb");
  ASSERT_EQ(pellucid_write_model(model.get(), written.c_str(), nullptr), pellucid_ok);
  EXPECT_EQ(primitive_of(read(written)).has_orders, 0U);
}

TEST(CModel, ErrorsNameTheFileAndTheReason) {
  PellucidModel* model = nullptr;
  EXPECT_EQ(pellucid_read_model("/nowhere/at.all.glb", &model), pellucid_bad_input);
  EXPECT_THAT(pellucid_last_error(), HasSubstr("/nowhere/at.all.glb"));
  EXPECT_EQ(model, nullptr);

  const ModelHandle torus_model = read(write_off(torus()));
  const Arrays other = torus(8, 4);
  const OrderSetHandle others = ordered(other.mesh(), quick_options());
  EXPECT_EQ(pellucid_model_set_orders(torus_model.get(), 0, others.get()), pellucid_bad_argument);
  EXPECT_THAT(pellucid_last_error(), HasSubstr("not of this primitive"));
  EXPECT_EQ(pellucid_model_set_orders(torus_model.get(), 7, nullptr), pellucid_bad_argument);
  EXPECT_EQ(pellucid_write_model(torus_model.get(), "/nowhere/out.glb", nullptr), pellucid_cannot_write);
}

}  // namespace
}  // namespace pellucid
