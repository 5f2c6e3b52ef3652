// Samples of high depth complexity: see dense_samples.h. The same numbers every time: each begins with a seed
// of its own.
#include "mesh/dense_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "mesh/sample_shapes.h"

namespace pellucid {
namespace {

std::uint32_t number_of(double count, double detail) {
  return std::max(2U, static_cast<std::uint32_t>(std::lround(count * detail)));
}

// Any direction across `axis`.
Vec3d across(const Vec3d& axis) {
  return normalized(cross(axis, std::abs(axis.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}));
}

std::uint32_t add_vertex(Mesh& mesh, const Vec3d& position) {
  mesh.positions.push_back(to_float(position));
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

// ---------------------------------------------------------------------------------------------------- hair

// A ribbon from `root` along `outward`, bent down by its weight and curled.
void add_strand(Mesh& mesh, const Vec3d& root, const Vec3d& outward, Random& random) {
  constexpr int kSegments = 6;
  constexpr double kWidth = 0.05;
  const double length = random.uniform(0.9, 1.5);
  const double phase = random.uniform(0, 2 * std::numbers::pi);
  const double curl = random.uniform(0.02, 0.07);
  const Vec3d side = across(outward);
  const Vec3d other = cross(outward, side);
  const auto point = [&](double t) {
    const double turn = phase + 9 * t;
    return root + outward * (0.55 * length * t) + Vec3d{0, -0.75 * length * t * t, 0} +
           side * (curl * std::cos(turn)) + other * (curl * std::sin(turn));
  };
  for (int i = 0; i <= kSegments; ++i) {
    const double t = static_cast<double>(i) / kSegments;
    const Vec3d along = normalized(point(t + 0.01) - point(t - 0.01));
    const Vec3d across_it = normalized(cross(along, side + other * 0.3)) * (0.5 * kWidth * (1 - 0.7 * t));
    const std::uint32_t left = add_vertex(mesh, point(t) - across_it);
    const std::uint32_t right = add_vertex(mesh, point(t) + across_it);
    if (i == 0) continue;
    mesh.triangles.push_back({left - 2, right - 2, right});
    mesh.triangles.push_back({left - 2, right, left});
  }
}

// --------------------------------------------------------------------------------------------------- smoke

void add_puff(Mesh& mesh, const Vec3d& center, double radius, const Vec3d& facing) {
  constexpr std::uint32_t kSegments = 24;
  const Vec3d u = across(facing);
  const Vec3d v = cross(facing, u);
  const std::uint32_t middle = add_vertex(mesh, center + facing * (0.15 * radius));
  for (std::uint32_t i = 0; i < kSegments; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSegments;
    const double reach = radius * (1 + 0.12 * std::sin(3 * angle + center.x * 9));
    add_vertex(mesh, center + u * (reach * std::cos(angle)) + v * (reach * std::sin(angle)));
    mesh.triangles.push_back({middle, middle + 1 + i, middle + 1 + (i + 1) % kSegments});
  }
}

// ---------------------------------------------------------------------------------------------- greenhouse

// Four triangles, folded along the middle.
void add_leaf(Mesh& mesh, const Vec3d& root, const Vec3d& along, double length) {
  const Vec3d side = across(along);
  const Vec3d up = cross(side, along);
  const std::uint32_t first = add_vertex(mesh, root);
  add_vertex(mesh, root + along * (0.45 * length) + side * (0.28 * length) + up * (0.1 * length));
  add_vertex(mesh, root + along * (0.5 * length));
  add_vertex(mesh, root + along * (0.45 * length) - side * (0.28 * length) + up * (0.1 * length));
  add_vertex(mesh, root + along * length - up * (0.15 * length));
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.triangles.push_back({first + 1, first + 4, first + 2});
  mesh.triangles.push_back({first + 2, first + 4, first + 3});
}

Mesh pane(double half_width, const Vec3f& place, double turned) {
  Mesh mesh = grid(half_width, 0, 2);
  for (Vec3f& p : mesh.positions) p = {p.x, p.z + static_cast<float>(half_width), 0};
  turn_about_y(mesh, turned);
  translate(mesh, place);
  return mesh;
}

void finish(std::vector<SamplePart>& parts) {
  for (SamplePart& part : parts) part.mesh.normals = vertex_normals(part.mesh);
}

}  // namespace

std::vector<SamplePart> make_hair(double detail) {
  std::vector<SamplePart> parts{{"hair-dark", {}, {0.10F, 0.05F, 0.03F, 0.45F}},
                                {"hair-brown", {}, {0.32F, 0.16F, 0.07F, 0.35F}},
                                {"hair-light", {}, {0.72F, 0.50F, 0.26F, 0.25F}}};
  Random random(92);
  const std::uint32_t strands = number_of(1500, detail);
  for (std::uint32_t i = 0; i < strands; ++i) {
    Vec3d outward = random.direction();
    outward.y = 0.4 * outward.y - 0.2;
    outward.z = std::abs(outward.z);
    outward = normalized(outward);
    const Vec3d root{0.8 * outward.x, 0.35 * outward.y + 0.4, 0.45 * outward.z};
    add_strand(parts[i % 3].mesh, root, outward, random);
  }
  finish(parts);
  if (parts[2].mesh.triangles.empty()) parts.pop_back();
  return parts;
}

std::vector<SamplePart> make_smoke(double detail) {
  std::vector<SamplePart> parts{{"smoke-soot", {}, {0.12F, 0.11F, 0.12F, 0.14F}},
                                {"smoke-gray", {}, {0.55F, 0.55F, 0.60F, 0.10F}},
                                {"smoke-fire", {}, {1.0F, 0.42F, 0.08F, 0.18F}}};
  Random random(16);
  const std::uint32_t puffs = number_of(260, detail);
  for (std::uint32_t i = 0; i < puffs; ++i) {
    const double height = std::pow(random.uniform(), 0.8) * 3;
    const double spread = 0.15 + 0.3 * height;
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const double away = spread * std::sqrt(random.uniform());
    const Vec3d center{away * std::cos(angle), height, away * std::sin(angle)};
    const double radius = random.uniform(0.2, 0.35) * (0.6 + 0.35 * height);
    // Fire below, soot above.
    const std::size_t part = height < random.uniform(0, 1.6) ? 2 : random.below(2);
    add_puff(parts[part].mesh, center, radius, random.direction());
  }
  std::erase_if(parts, [](const SamplePart& part) { return part.mesh.triangles.empty(); });
  finish(parts);
  return parts;
}

std::vector<SamplePart> make_shelf(const std::vector<SamplePart>& bottles) {
  constexpr int kRows = 3;
  std::vector<SamplePart> parts;
  for (int row = 0; row < kRows; ++row) {
    for (SamplePart part : bottles) {
      part.name.append("-").append(std::to_string(row + 1));
      for (Vec3f& p : part.mesh.positions) p.x *= row % 2 == 0 ? 1.0F : -1.0F;
      // Mirrored rows are turned inside out again.
      if (row % 2 == 1) part.mesh = flipped(part.mesh);
      translate(part.mesh, {0.25F * static_cast<float>(row % 2), 0, -1.7F * static_cast<float>(row)});
      part.mesh.normals = vertex_normals(part.mesh);
      std::swap(part.base_color.at(0), part.base_color.at(static_cast<std::size_t>(row) % 3));
      parts.push_back(std::move(part));
    }
  }
  return parts;
}

std::vector<SamplePart> make_greenhouse(double detail) {
  std::vector<SamplePart> parts{{"leaves-young", {}, {0.45F, 0.70F, 0.12F, 0.35F}},
                                {"leaves-old", {}, {0.06F, 0.28F, 0.07F, 0.60F}},
                                {"blossoms", {}, {0.85F, 0.12F, 0.35F, 0.50F}},
                                {"panes", {}, {0.75F, 0.90F, 0.95F, 0.15F}}};
  Random random(106);
  const std::uint32_t leaves = number_of(4200, detail);
  constexpr std::uint32_t kPlants = 24;
  for (std::uint32_t i = 0; i < leaves; ++i) {
    const std::uint32_t plant = i % kPlants;
    const std::uint32_t row = plant / 6;
    const Vec3d stem{-1.0 + 0.4 * (plant % 6), 0, -1.5 + 1.0 * row};
    const double height = random.uniform(0.1, 1.5);
    Vec3d along = random.direction();
    along.y = 0.5 * along.y + 0.3;
    along = normalized(along);
    const Vec3d root = stem + Vec3d{0, height, 0} + along * 0.08;
    const std::size_t part = i % 11 == 0 ? 2 : random.below(2);
    add_leaf(parts[part].mesh, root, along, random.uniform(0.5, 0.9) * (1.4 - 0.5 * height));
  }
  for (int i = 0; i < 5; ++i) {
    append(parts[3].mesh, pane(1.0, {-0.95F, 0, -2.0F + 1.0F * static_cast<float>(i)}, 0));
    append(parts[3].mesh, pane(1.0, {1.05F, 0, -1.98F + 1.0F * static_cast<float>(i)}, 0));
  }
  std::erase_if(parts, [](const SamplePart& part) { return part.mesh.triangles.empty(); });
  finish(parts);
  return parts;
}

}  // namespace pellucid
