// From the order of a simplified mesh to an order of the full one: see upsample.h.
#include "transparency/upsample/upsample.h"

#if PELLUCID_EMBREE_VERSION == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/parallel.h"

namespace pellucid {
namespace {

struct CloseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct CloseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, CloseDevice>;
using Scene = std::unique_ptr<RTCSceneTy, CloseScene>;

// Closest point of triangle abc to p (Ericson, "Real-Time Collision Detection", 2004, section 5.1.5, by
// regions).
double squared_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a;
  const Vec3d ac = c - a;
  const Vec3d normal = cross(ab, ac);
  const double area2 = dot(normal, normal);
  const auto to_segment = [&](const Vec3d& q, const Vec3d& r) {
    const Vec3d qr = r - q;
    const double l = dot(qr, qr);
    const double t = l > 0 ? std::clamp(dot(p - q, qr) / l, 0.0, 1.0) : 0.0;
    const Vec3d d = p - (q + qr * t);
    return dot(d, d);
  };
  if (area2 > 0) {
    const double u = dot(cross(c - b, p - b), normal);
    const double v = dot(cross(a - c, p - c), normal);
    const double w = dot(cross(ab, p - a), normal);
    if (u >= 0 && v >= 0 && w >= 0) {
      const double height = dot(p - a, normal);
      return height * height / area2;
    }
  }
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

struct Query {
  const Mesh& coarse;
  const std::vector<Vec3d>& coarse_normals;
  Vec3d point;
  Vec3d normal;
  double best = std::numeric_limits<double>::infinity();  // distance, with the penalty
  std::uint32_t triangle = std::numeric_limits<std::uint32_t>::max();
};

constexpr double kOtherSidePenalty = 4.0;

bool visit_triangle(RTCPointQueryFunctionArguments* args) {
  Query& query = *static_cast<Query*>(args->userPtr);
  const Triangle& t = query.coarse.triangles[args->primID];
  const double squared =
      squared_distance(query.point, to_double(query.coarse.positions[t[0]]),
                       to_double(query.coarse.positions[t[1]]), to_double(query.coarse.positions[t[2]]));
  const bool same_side = dot(query.normal, query.coarse_normals[args->primID]) > 0;
  const double distance = std::sqrt(squared) * (same_side ? 1.0 : kOtherSidePenalty);
  const bool nearer = distance < query.best || (distance == query.best && args->primID < query.triangle);
  if (!nearer) return false;
  query.best = distance;
  query.triangle = args->primID;
  // A little wider than the best, so that equal distances are all seen whatever the order of the visit.
  const auto radius = static_cast<float>(distance * (1.0 + 1e-5));
  if (radius >= args->query->radius) return false;
  args->query->radius = radius;
  return true;
}

std::vector<Vec3d> normals_of(const Mesh& mesh) {
  std::vector<Vec3d> normals(mesh.triangles.size());
  for (std::uint32_t t = 0; t < normals.size(); ++t) normals[t] = triangle_normal(mesh, t);
  return normals;
}

Scene build_scene(RTCDevice device, const Mesh& mesh) {
  Scene scene(rtcNewScene(device));
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vec3f), mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(Triangle), mesh.triangles.size());
  std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<Vec3f*>(vertices));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<Triangle*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  return scene;
}

}  // namespace

std::vector<NodeId> nearest_coarse_nodes(const Mesh& fine, const Mesh& coarse) {
  const Device device(rtcNewDevice(nullptr));
  if (device == nullptr) throw Error(ErrorKind::internal, "Embree cannot start on this machine");
  const Scene scene = build_scene(device.get(), coarse);
  const std::vector<Vec3d> coarse_normals = normals_of(coarse);
  std::vector<NodeId> nodes(2 * fine.triangles.size());
  parallel_loop(std::uint32_t{0}, static_cast<std::uint32_t>(fine.triangles.size()), [&](std::uint32_t t) {
    const Triangle& corners = fine.triangles[t];
    const Vec3d centroid = (to_double(fine.positions[corners[0]]) + to_double(fine.positions[corners[1]]) +
                            to_double(fine.positions[corners[2]])) /
                           3.0;
    const Vec3f p = to_float(centroid);
    Query query{coarse, coarse_normals, centroid, triangle_normal(fine, t)};
    RTCPointQuery point_query{p.x, p.y, p.z, 0.0F, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene.get(), &point_query, &context, visit_triangle, &query);
    const std::uint32_t nearest = query.triangle < coarse.triangles.size() ? query.triangle : 0;
    const bool turned = dot(query.normal, coarse_normals[nearest]) < 0;
    nodes[2 * t] = node_of(nearest, turned);
    nodes[2 * t + 1] = node_of(nearest, !turned);
  });
  return nodes;
}

std::vector<double> upsampled_keys(std::span<const NodeId> coarse_nodes,
                                   std::span<const std::uint32_t> coarse_ranks,
                                   std::span<const double> depth_keys) {
  std::vector<double> keys(coarse_nodes.size());
  for (std::size_t node = 0; node < keys.size(); ++node) {
    // Depth keys lie in -1 .. 1: less than one rank.
    keys[node] = coarse_ranks[coarse_nodes[node]] + 0.45 * std::clamp(depth_keys[node], -1.0, 1.0);
  }
  return keys;
}

}  // namespace pellucid
