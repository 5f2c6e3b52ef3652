// Tests animated characters that others have made: every clip can be posed and fills the box that it is known
// to fill.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "pellucid/scene.h"
#include "pellucid/subdivide.h"

namespace pellucid {
namespace {

namespace fs = std::filesystem;

struct Box {
  Vec3d low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};

  void add(const Vec3f& p) {
    low = {std::min<double>(low.x, p.x), std::min<double>(low.y, p.y), std::min<double>(low.z, p.z)};
    high = {std::max<double>(high.x, p.x), std::max<double>(high.y, p.y), std::max<double>(high.z, p.z)};
  }
};

// The box over all clips, from `poses` evenly spaced poses of each, both ends included.
Box box_over_clips(const PosableModel& model, int poses) {
  Box box;
  std::vector<Vec3f> positions;
  for (std::uint32_t clip = 0; clip < model.clips().size(); ++clip) {
    const double first = model.clips()[clip].key_times.front(), last = model.clips()[clip].key_times.back();
    for (int i = 0; i < poses; ++i) {
      model.pose(clip, first + (last - first) * i / (poses - 1), positions);
      for (const Vec3f& p : positions) box.add(p);
    }
  }
  return box;
}

void expect_box(const std::string& name, const Vec3d& low, const Vec3d& high) {
  const std::string path = std::string(PELLUCID_MODELS) + "/animated/" + name;
  if (!fs::exists(path)) GTEST_SKIP() << "development model missing: " << path;
  const Box box = box_over_clips(PosableModel(read_model(path)), 5);
  const double tolerance = 0.01 * length(high - low);
  EXPECT_LT(length(box.low - low), tolerance) << box.low.x << " " << box.low.y << " " << box.low.z;
  EXPECT_LT(length(box.high - high), tolerance) << box.high.x << " " << box.high.y << " " << box.high.z;
}

// As listed in the models' own table, which another program made from five poses of every clip.
TEST(AnimatedModels, FoxFillsItsBox) {
  expect_box("Fox.glb", {-29.9, -2.47, -96.6}, {19, 79.1, 75.2});
}
TEST(AnimatedModels, CesiumManFillsHisBox) {
  expect_box("CesiumMan.glb", {-0.31, -0.0106, -0.502}, {0.206, 1.51, 0.462});
}
TEST(AnimatedModels, SoldierFillsHisBox) {
  expect_box("Soldier_act.glb", {-0.725, -0.00338, -0.719}, {0.752, 2.07, 0.836});
}
TEST(AnimatedModels, XbotFillsItsBox) {
  expect_box("Xbot.glb", {-0.327, -0.00268, -0.61}, {0.37, 1.8, 0.617});
}
TEST(AnimatedModels, RobotFillsItsBox) {
  expect_box("RobotExpressive.glb", {-3.34, -0.371, -6.43}, {2.87, 5.91, 2.34});
}
TEST(AnimatedModels, KnightFillsHisBox) {
  expect_box("KayKit_Knight.glb", {-2.72, -0.369, -3.04}, {2.16, 3.43, 2.71});
}

TEST(AnimatedModels, AllCanBePosedAndSubdivided) {
  if (!can_subdivide()) GTEST_SKIP() << "this build has no OpenSubdiv";
  const fs::path folder = fs::path(PELLUCID_MODELS) / "animated";
  if (!fs::is_directory(folder)) GTEST_SKIP() << "development model missing: " << folder.string();
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".glb") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const Model model = read_model(entry.path().string());
    const PosableModel coarse(model), fine(model, 1);
    EXPECT_FALSE(coarse.clips().empty());
    // Degenerate triangles have no children.
    EXPECT_LE(fine.triangles().size(), 4 * coarse.triangles().size());
    EXPECT_GE(fine.triangles().size(), 4 * coarse.triangles().size() * 9 / 10);
    const Box box = box_over_clips(coarse, 3), fine_box = box_over_clips(fine, 3);
    for (const double value : {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z}) {
      EXPECT_TRUE(std::isfinite(value));
    }
    // Subdivision smooths: the surface stays about where it was.
    const double tolerance = 0.05 * length(box.high - box.low);
    EXPECT_LT(length(box.low - fine_box.low), tolerance);
    EXPECT_LT(length(box.high - fine_box.high), tolerance);
  }
}

}  // namespace
}  // namespace pellucid
