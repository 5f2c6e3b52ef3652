// Tests the raster against an independent implementation: rays of Embree through pixel centres must meet the
// triangles that the raster lists.
#if PELLUCID_EMBREE_VERSION == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "raster_helpers.h"

namespace pellucid {
namespace {

using testing::fragments_of;
using testing::wrinkled_sphere;

// Collects every triangle that a ray meets.
struct AllHits {
#if PELLUCID_EMBREE_VERSION == 4
  RTCRayQueryContext context;
#else
  RTCIntersectContext context;
#endif
  std::vector<std::uint32_t> nodes;
};

void intersect(RTCScene scene, AllHits& all, RTCRayHit& ray) {
#if PELLUCID_EMBREE_VERSION == 4
  rtcInitRayQueryContext(&all.context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &all.context;
  rtcIntersect1(scene, &ray, &arguments);
#else
  rtcInitIntersectContext(&all.context);
  rtcIntersect1(scene, &all.context, &ray);
#endif
}

void gather(const RTCFilterFunctionNArguments* arguments) {
  auto* all = reinterpret_cast<AllHits*>(arguments->context);
  RTCHitN* hit = arguments->hit;
  const std::uint32_t triangle = RTCHitN_primID(hit, arguments->N, 0);
  const Vec3f normal{RTCHitN_Ng_x(hit, arguments->N, 0), RTCHitN_Ng_y(hit, arguments->N, 0),
                     RTCHitN_Ng_z(hit, arguments->N, 0)};
  const Vec3f direction{RTCRayN_dir_x(arguments->ray, arguments->N, 0),
                        RTCRayN_dir_y(arguments->ray, arguments->N, 0),
                        RTCRayN_dir_z(arguments->ray, arguments->N, 0)};
  all->nodes.push_back(2 * triangle + (dot(normal, direction) > 0 ? 1 : 0));
  arguments->valid[0] = 0;  // go on along the ray
}

class EmbreeScene {
 public:
  explicit EmbreeScene(const Mesh& mesh) : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), mesh.positions.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), positions);
    auto* triangles = static_cast<Triangle*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size()));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    rtcSetGeometryIntersectFilterFunction(geometry, gather);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  // Returns the nodes along the ray through the centre of a pixel, sorted by id.
  [[nodiscard]] std::vector<std::uint32_t> hits(const Camera& camera, std::uint32_t x,
                                                std::uint32_t y) const {
    const double unit = 2 * camera.half_height / camera.height;
    const Vec3d offset = camera.right * ((x + 0.5 - camera.width / 2.0) * unit) -
                         camera.up * ((y + 0.5 - camera.height / 2.0) * unit);
    const Vec3f origin = to_float(camera.perspective ? camera.eye : camera.eye + offset);
    const Vec3f direction = to_float(camera.perspective ? camera.forward + offset : camera.forward);
    RTCRayHit ray{};
    ray.ray.org_x = origin.x;
    ray.ray.org_y = origin.y;
    ray.ray.org_z = origin.z;
    ray.ray.dir_x = direction.x;
    ray.ray.dir_y = direction.y;
    ray.ray.dir_z = direction.z;
    ray.ray.tnear = static_cast<float>(camera.near_plane);
    ray.ray.tfar = static_cast<float>(camera.far_plane);
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    AllHits all{};
    intersect(scene_, all, ray);
    std::sort(all.nodes.begin(), all.nodes.end());
    return all.nodes;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

// Returns the share of pixels whose set of nodes differs from that of Embree. The raster snaps vertices to
// 1/256 pixel, so a centre that near to an edge may be on either side.
double disagreement(const Mesh& mesh, const Camera& camera) {
  const EmbreeScene embree(mesh);
  const FragmentBuffer buffer = fragments_of(mesh, camera);
  std::size_t different = 0;
  std::size_t covered = 0;
  for (std::uint32_t y = 0; y < camera.height; ++y) {
    for (std::uint32_t x = 0; x < camera.width; ++x) {
      std::vector<std::uint32_t> nodes;
      for (const Fragment& f : buffer.pixel(std::size_t{y} * camera.width + x)) nodes.push_back(f.node);
      std::sort(nodes.begin(), nodes.end());
      const std::vector<std::uint32_t> expected = embree.hits(camera, x, y);
      covered += nodes.empty() && expected.empty() ? 0U : 1U;
      different += nodes == expected ? 0U : 1U;
    }
  }
  EXPECT_GT(covered, std::size_t{camera.width} * camera.height / 10);
  return static_cast<double>(different) / static_cast<double>(covered);
}

Camera camera_at(const Vec3d& direction, double distance, std::uint32_t size) {
  return look_at_sphere({{0, 0, 0}, 1}, {normalized(direction), distance}, size, size);
}

TEST(AgainstEmbree, AgreesOnAWrinkledSphere) {
  // A triangle has about 60 pixels. Its outline is 40 pixels long, of which 1 / 128 counts as near.
  const Mesh mesh = wrinkled_sphere(30, 0.2);
  EXPECT_LT(disagreement(mesh, camera_at({1, 2, 3}, 3, 300)), 0.01);
  EXPECT_LT(disagreement(mesh, camera_at({-1, 0.2, 0.1}, kInfiniteDistance, 300)), 0.01);
  EXPECT_LT(disagreement(mesh, camera_at({-1, 0.2, 0.1}, 0.4, 300)), 0.01);
}

TEST(AgainstEmbree, AgreesOnRandomTriangles) {
  const Mesh mesh = testing::random_soup(100, 0.25, 4, 0.5);
  EXPECT_LT(disagreement(mesh, camera_at({1, 2, -3}, 2.5, 300)), 0.02);
  EXPECT_LT(disagreement(mesh, camera_at({1, 0, 0}, kInfiniteDistance, 300)), 0.02);
}

// Reads the positions and triangles of the OBJ file that is used here.
Mesh read_plain_obj(std::istream& in) {
  Mesh mesh;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3f p;
      words >> p.x >> p.y >> p.z;
      mesh.positions.push_back(p);
    } else if (word == "f") {
      Triangle t{};
      for (std::uint32_t& index : t) {
        words >> word;
        index = static_cast<std::uint32_t>(std::stoul(word)) - 1;
      }
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

TEST(AgainstEmbree, BunnyAndItsLayers) {
  std::ifstream file(PELLUCID_MODELS "/static/bunny_10k.obj");
  if (!file) GTEST_SKIP() << "development model missing: " PELLUCID_MODELS "/static/bunny_10k.obj";
  const Mesh mesh = read_plain_obj(file);
  ASSERT_EQ(mesh.triangles.size(), 10000U);
  const BoundingSphere sphere = bounding_sphere(mesh);
  EXPECT_LT(disagreement(mesh, look_at_sphere(sphere, {normalized(Vec3d{1, 1, 1}), 3}, 384, 384)), 0.02);

  // Published with the model: at most 12 layers and 2.17 on average, over ten oblique directions at 768 x
  // 768.
  Random random(6);
  std::size_t covered = 0, fragments = 0, deepest = 0;
  for (int i = 0; i < 10; ++i) {
    const FragmentBuffer buffer =
        fragments_of(mesh, look_at_sphere(sphere, {random.direction(), kInfiniteDistance}, 768, 768));
    covered += buffer.covered_pixels();
    fragments += buffer.fragments.size();
    for (std::size_t p = 0; p < 768 * 768; ++p) deepest = std::max(deepest, buffer.pixel(p).size());
  }
  EXPECT_NEAR(static_cast<double>(fragments) / static_cast<double>(covered), 2.17, 0.1);
  EXPECT_GE(deepest, 8U);
  EXPECT_LE(deepest, 16U);
}

}  // namespace
}  // namespace pellucid
