// Tests deep images: OpenEXR reads from the file what was drawn, and compositing it gives the same image.
#include "pellucid/deep_image.h"

#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "pellucid/view.h"

namespace pellucid {
namespace {

// Two sheets. The far one lies behind half of the near one.
RenderScene two_sheets() {
  RenderScene scene;
  const auto add_sheet = [&](float z, float right, std::uint32_t object) {
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const Vec3f& corner : {Vec3f{-1, -1, z}, {right, -1, z}, {right, 1, z}, {-1, 1, z}})
      scene.positions.push_back(corner);
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.triangles.push_back({first, first + 2, first + 3});
    scene.objects.insert(scene.objects.end(), 2, object);
  };
  add_sheet(0.2F, 1, 0);
  add_sheet(-0.3F, 0, 1);
  scene.normals.assign(scene.positions.size(), {});
  scene.surfaces = {{.color = {0.8F, 0.1F, 0.1F}, .alpha = 0.25F},
                    {.color = {0.1F, 0.2F, 0.9F}, .alpha = 0.75F}};
  return scene;
}

class DeepImages : public ::testing::Test {
 protected:
  void SetUp() override {
    camera_ = look_at_sphere({{0, 0, 0}, 1.5}, {normalized(Vec3d{0, 0, 1}), 3}, 24, 16);
    drawn_ = draw_reference(scene_, camera_, {.keep_fragments = true});
    deep_ = make_deep_image(drawn_, scene_, camera_);
  }
  RenderScene scene_ = two_sheets();
  Camera camera_;
  RenderResult drawn_;
  DeepImage deep_;
};

TEST_F(DeepImages, HoldAllFragmentsOfAPixel) {
  const auto left = deep_.at(10, 8);
  ASSERT_EQ(left.size(), 2U);
  EXPECT_EQ(left[0].object, 0U);
  EXPECT_EQ(left[1].object, 1U);
  EXPECT_GE(triangle_of(left[1].node), 2U);
  // The camera is 4.5 from the middle, and looks along -z.
  EXPECT_NEAR(left[0].distance, 4.5F - 0.2F, 1e-4F);
  EXPECT_NEAR(left[1].distance, 4.5F + 0.3F, 1e-4F);
  EXPECT_NEAR(left[0].color[3], 0.25F, 0.01F);
  EXPECT_EQ(deep_.at(14, 8).size(), 1U);
  EXPECT_TRUE(deep_.at(0, 0).empty());
}

TEST_F(DeepImages, NeedColours) {
  drawn_.fragments.colors.clear();
  EXPECT_THROW(make_deep_image(drawn_, scene_, camera_), Error);
}

// Reads all channels of a file, fragment by fragment.
DeepImage read_deep_exr(const std::string& path) {
  Imf::DeepScanLineInputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  DeepImage image{
      static_cast<std::uint32_t>(window.max.x + 1), static_cast<std::uint32_t>(window.max.y + 1), {0}, {}};
  const std::size_t pixels = std::size_t{image.width} * image.height;
  std::vector<std::uint32_t> counts(pixels);
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 4 * std::size_t{image.width}));
  file.setFrameBuffer(buffer);
  file.readPixelSampleCounts(0, window.max.y);
  for (const std::uint32_t count : counts) image.offsets.push_back(image.offsets.back() + count);
  image.fragments.resize(image.offsets.back());
  std::vector<std::vector<char*>> places;
  const auto take = [&](const char* name, Imf::PixelType type, auto member) {
    std::vector<char*>& rows = places.emplace_back();
    for (std::size_t p = 0; p < pixels; ++p)
      rows.push_back(reinterpret_cast<char*>(member(image.fragments.data() + image.offsets[p])));
    buffer.insert(name, Imf::DeepSlice(type, reinterpret_cast<char*>(rows.data()), sizeof(char*),
                                       sizeof(char*) * image.width, sizeof(DeepFragment)));
  };
  for (std::size_t c = 0; c < 4; ++c)
    take(std::array{"R", "G", "B", "A"}.at(c), Imf::FLOAT,
         [c](DeepFragment* f) { return f->color.data() + c; });
  take("Z", Imf::FLOAT, [](DeepFragment* f) { return &f->distance; });
  take("object", Imf::UINT, [](DeepFragment* f) { return &f->object; });
  take("node", Imf::UINT, [](DeepFragment* f) { return &f->node; });
  file.setFrameBuffer(buffer);
  file.readPixelSampleCounts(0, window.max.y);
  file.readPixels(0, window.max.y);
  return image;
}

TEST_F(DeepImages, RoundTripThroughAFile) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "pellucid_deep_test.exr";
  write_deep_exr(deep_, path.string());
  const DeepImage read = read_deep_exr(path.string());
  std::filesystem::remove(path);
  ASSERT_EQ(read.offsets, deep_.offsets);
  for (std::size_t i = 0; i < deep_.fragments.size(); ++i) {
    const DeepFragment& wanted = deep_.fragments[i];
    const DeepFragment& found = read.fragments[i];
    EXPECT_EQ(found.node, wanted.node);
    EXPECT_EQ(found.object, wanted.object);
    EXPECT_EQ(found.distance, wanted.distance);
    EXPECT_EQ(found.color[3], wanted.color[3]);
    EXPECT_EQ(found.color[0], wanted.color[0] * wanted.color[3]);
  }
  // Compositing the premultiplied colours over the white background gives the image.
  for (std::size_t p = 0; p < drawn_.pixels.size(); ++p) {
    Vec3f sum{0, 0, 0};
    float through = 1;
    for (std::uint64_t i = read.offsets[p]; i < read.offsets[p + 1]; ++i) {
      const auto& c = read.fragments[i].color;
      sum = sum + Vec3f{c[0], c[1], c[2]} * through;
      through *= 1 - c[3];
    }
    const Vec3f over = sum + Vec3f{1, 1, 1} * through;
    EXPECT_NEAR(over.x, drawn_.pixels[p].x, 1e-5F);
    EXPECT_NEAR(over.z, drawn_.pixels[p].z, 1e-5F);
  }
}

TEST_F(DeepImages, ThrowWhereTheFileCannotBeWritten) {
  try {
    write_deep_exr(deep_, "/nowhere/deep.exr");
    FAIL() << "it was written";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::cannot_write);
  }
}

}  // namespace
}  // namespace pellucid
