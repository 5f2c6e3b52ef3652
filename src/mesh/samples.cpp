// Implements the procedural samples of pellucid/mesh.h, so that no model must be downloaded. They are one to
// four units tall. Samples with random parts begin with a fixed seed, so that they are the same every time.
//
// The dense samples stand for the scenes of Vasilakis et al., "Variable k-buffer using importance maps",
// Eurographics 2017, Table 2.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "mesh/sample_shapes.h"
#include "pellucid/mesh.h"

namespace pellucid {
namespace {

using Color = std::array<float, 4>;

// Scales a linear resolution that is `count` at detail 1. The number of triangles grows with its square.
std::uint32_t scaled(double count, double detail, std::uint32_t at_least) {
  return std::max(at_least, static_cast<std::uint32_t>(std::lround(count * std::sqrt(detail))));
}

// ------------------------------------------------------------------------------------------------ goblet

std::vector<SamplePart> make_goblet(double detail) {
  // From below the foot, up the stem and the outside of the bowl, over the rim, down the inside to its floor.
  constexpr std::array<ProfilePoint, 27> kControls{
      {{0, 0.03},    {0.25, 0.022}, {0.46, 0.0},  {0.52, 0.014},  {0.49, 0.04},  {0.33, 0.065},
       {0.14, 0.12}, {0.065, 0.24}, {0.05, 0.42}, {0.095, 0.52},  {0.05, 0.62},  {0.065, 0.78},
       {0.2, 0.92},  {0.42, 1.12},  {0.52, 1.42}, {0.49, 1.75},   {0.438, 1.99}, {0.425, 2.005},
       {0.41, 1.99}, {0.46, 1.75},  {0.49, 1.42}, {0.395, 1.145}, {0.28, 1.03},  {0.19, 0.965},
       {0.12, 0.93}, {0.05, 0.912}, {0, 0.91}}};
  const Profile profile = smooth_profile(kControls, scaled(3, detail, 1));
  return {{"goblet", revolve(profile, scaled(72, detail, 6)), {0.75F, 0.9F, 0.95F, 0.35F}}};
}

// ------------------------------------------------------------------------------------------- torus knot

// The (2, 3) torus knot on a torus with radii 1 and 0.5.
CurvePoint torus_knot_point(double t) {
  constexpr double kMinor = 0.5;
  constexpr double kRound = 2;
  constexpr double kThrough = 3;
  const double u = 2.0 * std::numbers::pi * t;
  const Vec3d outward{std::cos(kRound * u), std::sin(kRound * u), 0};
  const Vec3d sideways{-outward.y, outward.x, 0};
  const double reach = 1.0 + kMinor * std::cos(kThrough * u);
  CurvePoint point;
  point.position = outward * reach + Vec3d{0, 0, kMinor * std::sin(kThrough * u)};
  point.tangent = sideways * (kRound * reach) - outward * (kMinor * kThrough * std::sin(kThrough * u)) +
                  Vec3d{0, 0, kMinor * kThrough * std::cos(kThrough * u)};
  // The normal of the torus is never parallel to the curve, and it is periodic.
  point.side = outward * std::cos(kThrough * u) + Vec3d{0, 0, std::sin(kThrough * u)};
  return point;
}

std::vector<SamplePart> make_torus_knot(double detail) {
  return {{"torus-knot",
           tube(torus_knot_point, 0.22, scaled(220, detail, 24), scaled(28, detail, 6)),
           {0.9F, 0.45F, 0.2F, 0.5F}}};
}

// ---------------------------------------------------------------------------------------- nested shells

std::vector<SamplePart> make_nested_shells(double detail) {
  struct Shell {
    double radius, frequency, phase;
    Color color;
  };
  constexpr std::array<Shell, 5> kShells{{{1.00, 5, 0.0, {0.85F, 0.25F, 0.25F, 0.3F}},
                                          {0.80, 7, 1.1, {0.9F, 0.7F, 0.2F, 0.35F}},
                                          {0.60, 4, 2.3, {0.3F, 0.75F, 0.35F, 0.4F}},
                                          {0.42, 6, 0.7, {0.25F, 0.5F, 0.9F, 0.45F}},
                                          {0.25, 3, 1.9, {0.6F, 0.3F, 0.8F, 0.6F}}}};
  // With bumps of 6 % neighbouring shells do not touch, even where a coarse lattice cuts corners.
  constexpr double kBump = 0.06;
  std::vector<SamplePart> parts;
  for (const Shell& shell : kShells) {
    const auto radius = [&](const Vec3d& d) {
      const double waves = std::sin(shell.frequency * d.x + shell.phase) +
                           std::sin(shell.frequency * d.y + 2 * shell.phase) +
                           std::sin(shell.frequency * d.z + 3 * shell.phase);
      return shell.radius * (1.0 + kBump * waves / 3.0);
    };
    parts.push_back({"shell-" + std::to_string(parts.size() + 1), star_shape(radius, scaled(13, detail, 6)),
                     shell.color});
  }
  return parts;
}

// --------------------------------------------------------------------------------------- coplanar stack

// Returns five discs with exactly the same positions, one of them facing down.
Mesh coincident_discs(double detail) {
  const Mesh one = disc(0.9, 0.0, scaled(24, detail, 8));
  Mesh mesh;
  for (int i = 0; i < 5; ++i) append(mesh, i == 2 ? flipped(one) : one);
  return mesh;
}

// Returns overlapping shapes with different triangulations in exactly one plane.
Mesh overlapping_shapes(double detail) {
  Mesh mesh = grid(0.8, 0.0, scaled(4, detail, 1));
  append(mesh, disc(0.7, 0.0, scaled(20, detail, 8)));
  Mesh turned = grid(0.75, 0.0, scaled(3, detail, 1));
  turn_about_y(turned, 0.6);
  append(mesh, turned);
  append(mesh, disc(0.4, 0.0, 5));
  return mesh;
}

// Returns sheets whose distances from the first one grow tenfold, from 1e-7 to 0.1.
Mesh almost_coplanar_sheets(double detail) {
  Mesh mesh = grid(0.8, 0.0, scaled(4, detail, 1));
  for (const double height : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
    Mesh sheet = grid(0.8, height, scaled(4, detail, 1));
    append(mesh, sheet);
  }
  return mesh;
}

std::vector<SamplePart> make_coplanar_stack(double detail) {
  std::vector<SamplePart> parts{
      {"coincident-discs", coincident_discs(detail), {0.85F, 0.3F, 0.3F, 0.4F}},
      {"overlapping-shapes", overlapping_shapes(detail), {0.3F, 0.7F, 0.4F, 0.4F}},
      {"almost-coplanar-sheets", almost_coplanar_sheets(detail), {0.3F, 0.45F, 0.85F, 0.4F}}};
  float x = -2.0F;
  for (SamplePart& part : parts) {
    translate(part.mesh, {x, 0, 0});
    x += 2.0F;
  }
  return parts;
}

// ---------------------------------------------------------------------------------------------- bottles

struct BottleShape {
  std::string name;
  std::vector<ProfilePoint> outside;  // from the axis under the base up to the mouth
  double wall = 0.03;
  double fill_height = 1;
  double label_bottom = 0, label_top = 0;
  double depth_scale = 1;
  Vec3f position;
  Color glass, liquid, label;
};

// Appends a half circle from `outer` to `inner`.
void append_lip(Profile& profile, const ProfilePoint& outer, const ProfilePoint& inner, std::uint32_t steps) {
  const double middle = (outer.radius + inner.radius) / 2;
  const double radius = (outer.radius - inner.radius) / 2;
  for (std::uint32_t k = 1; k < steps; ++k) {
    const double angle = std::numbers::pi * k / steps;
    profile.push_back({middle + radius * std::cos(angle), outer.height + radius * std::sin(angle)});
  }
}

Profile glass_profile(const Profile& outside, double wall) {
  const Profile inside = offset_profile(outside, wall);
  Profile profile = outside;
  append_lip(profile, outside.back(), inside.back(), 4);
  profile.insert(profile.end(), inside.rbegin(), inside.rend());
  return profile;
}

// Returns the point where the profile first reaches `height`.
ProfilePoint climb_past(const Profile& profile, double height) {
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const ProfilePoint& low = profile[i - 1];
    const ProfilePoint& high = profile[i];
    if (low.height <= height && height < high.height) {
      return {std::lerp(low.radius, high.radius, (height - low.height) / (high.height - low.height)), height};
    }
  }
  return profile.back();
}

// Returns the profile of the liquid up to `fill_height`, with a small gap to the glass.
Profile liquid_profile(const Profile& outside, double wall, double fill_height) {
  constexpr double kGap = 0.012;
  const Profile inside = offset_profile(outside, wall + kGap);
  Profile profile;
  for (const ProfilePoint& p : inside) {
    if (p.height >= fill_height) break;
    profile.push_back(p);
  }
  const ProfilePoint brim = climb_past(inside, fill_height);
  constexpr int kRings = 4;
  for (int i = kRings; i >= 0; --i) profile.push_back({brim.radius * i / kRings, fill_height});
  return profile;
}

// Returns the profile of an open band around the bottle, with a small gap to the glass.
Profile label_profile(const Profile& outside, double bottom, double top, std::uint32_t steps) {
  constexpr double kGap = 0.006;
  const Profile around = offset_profile(outside, -kGap);
  Profile profile;
  for (std::uint32_t i = 0; i <= steps; ++i) {
    profile.push_back(climb_past(around, std::lerp(bottom, top, static_cast<double>(i) / steps)));
  }
  return profile;
}

void add_bottle(std::vector<SamplePart>& parts, const BottleShape& shape, double detail) {
  const std::uint32_t segments = scaled(32, detail, 8);
  const Profile outside = smooth_profile(shape.outside, scaled(3, detail, 2));
  const auto add = [&](const std::string& what, const Profile& profile, const Color& color) {
    SamplePart part{shape.name + "-" + what, revolve(profile, segments, shape.depth_scale), color};
    translate(part.mesh, shape.position);
    parts.push_back(std::move(part));
  };
  add("glass", glass_profile(outside, shape.wall), shape.glass);
  add("liquid", liquid_profile(outside, shape.wall, shape.fill_height), shape.liquid);
  add("label", label_profile(outside, shape.label_bottom, shape.label_top, scaled(8, detail, 2)),
      shape.label);
}

std::vector<SamplePart> make_bottles(double detail) {
  const std::array<BottleShape, 3> shapes{{{"wine",
                                            {{0, 0.1},
                                             {0.2, 0.06},
                                             {0.33, 0.0},
                                             {0.385, 0.06},
                                             {0.39, 0.3},
                                             {0.39, 0.7},
                                             {0.39, 1.1},
                                             {0.39, 1.5},
                                             {0.36, 1.8},
                                             {0.22, 2.1},
                                             {0.14, 2.4},
                                             {0.13, 2.7},
                                             {0.15, 2.82},
                                             {0.15, 2.95}},
                                            0.03,
                                            1.7,
                                            0.45,
                                            1.3,
                                            1.0,
                                            {-1.2F, 0, 0},
                                            {0.2F, 0.55F, 0.25F, 0.45F},
                                            {0.45F, 0.02F, 0.08F, 0.7F},
                                            {0.95F, 0.92F, 0.8F, 0.85F}},
                                           {"flask",
                                            {{0, 0.0},
                                             {0.3, 0.0},
                                             {0.5, 0.05},
                                             {0.66, 0.3},
                                             {0.7, 0.6},
                                             {0.62, 0.95},
                                             {0.42, 1.2},
                                             {0.22, 1.4},
                                             {0.16, 1.65},
                                             {0.17, 1.85},
                                             {0.23, 1.95},
                                             {0.24, 2.0}},
                                            0.04,
                                            0.9,
                                            0.45,
                                            0.75,
                                            1.0,
                                            {0.3F, 0, 0.2F},
                                            {0.8F, 0.9F, 0.95F, 0.3F},
                                            {0.2F, 0.5F, 0.9F, 0.5F},
                                            {0.9F, 0.6F, 0.3F, 0.8F}},
                                           {"hip-flask",
                                            {{0, 0.03},
                                             {0.3, 0.02},
                                             {0.5, 0.02},
                                             {0.58, 0.1},
                                             {0.6, 0.4},
                                             {0.6, 0.8},
                                             {0.6, 1.2},
                                             {0.5, 1.45},
                                             {0.28, 1.55},
                                             {0.16, 1.68},
                                             {0.14, 1.85},
                                             {0.15, 1.95}},
                                            0.035,
                                            1.15,
                                            0.45,
                                            0.95,
                                            0.5,
                                            {1.7F, 0, -0.1F},
                                            {0.85F, 0.8F, 0.7F, 0.35F},
                                            {0.8F, 0.45F, 0.1F, 0.6F},
                                            {0.3F, 0.3F, 0.35F, 0.85F}}}};
  std::vector<SamplePart> parts;
  for (const BottleShape& shape : shapes) add_bottle(parts, shape, detail);
  return parts;
}

// ------------------------------------------------------------------------- parts shared by the dense samples

std::uint32_t number_of(double count, double detail) {
  return std::max(2U, static_cast<std::uint32_t>(std::lround(count * detail)));
}

// Returns a direction at a right angle to `axis`.
Vec3d across(const Vec3d& axis) {
  return normalized(cross(axis, std::abs(axis.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}));
}

std::uint32_t add_vertex(Mesh& mesh, const Vec3d& position) {
  mesh.positions.push_back(to_float(position));
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

void finish(std::vector<SamplePart>& parts) {
  for (SamplePart& part : parts) part.mesh.normals = vertex_normals(part.mesh);
}

// ------------------------------------------------------------------------------------------------------ hair

// Adds a curled ribbon that starts at `root` along `outward` and bends down.
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

// Returns curly strands that hang from half an ellipsoid.
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

// ----------------------------------------------------------------------------------------------------- smoke

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

// Returns a cloud of thin discs in all directions.
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
    // Put fire at the bottom and soot above it.
    const std::size_t part = height < random.uniform(0, 1.6) ? 2 : random.below(2);
    add_puff(parts[part].mesh, center, radius, random.direction());
  }
  std::erase_if(parts, [](const SamplePart& part) { return part.mesh.triangles.empty(); });
  finish(parts);
  return parts;
}

// ----------------------------------------------------------------------------------------------------- shelf

// Returns rows of the bottles behind each other.
std::vector<SamplePart> make_shelf(const std::vector<SamplePart>& bottles) {
  constexpr int kRows = 3;
  std::vector<SamplePart> parts;
  for (int row = 0; row < kRows; ++row) {
    for (SamplePart part : bottles) {
      part.name.append("-").append(std::to_string(row + 1));
      for (Vec3f& p : part.mesh.positions) p.x *= row % 2 == 0 ? 1.0F : -1.0F;
      // Mirroring reverses the winding, so reverse it again.
      if (row % 2 == 1) part.mesh = flipped(part.mesh);
      translate(part.mesh, {0.25F * static_cast<float>(row % 2), 0, -1.7F * static_cast<float>(row)});
      part.mesh.normals = vertex_normals(part.mesh);
      std::swap(part.base_color.at(0), part.base_color.at(static_cast<std::size_t>(row) % 3));
      parts.push_back(std::move(part));
    }
  }
  return parts;
}

std::vector<SamplePart> make_shelf_of_bottles(double detail) {
  return make_shelf(make_bottles(0.2 * detail));
}

// ------------------------------------------------------------------------------------------------ greenhouse

// Adds a leaf of four triangles, folded along the middle.
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

// Returns plants of many leaves behind panes of glass.
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

// ------------------------------------------------------------------------------------------------- list

using SampleMaker = std::vector<SamplePart> (*)(double detail);
constexpr std::array<SampleMaker, 9> kMakers{make_goblet,         make_torus_knot,       make_nested_shells,
                                             make_coplanar_stack, make_bottles,          make_hair,
                                             make_smoke,          make_shelf_of_bottles, make_greenhouse};

}  // namespace

std::span<const SampleInfo> sample_list() {
  static const std::array<SampleInfo, kMakers.size()> list{
      {{"goblet", "a wine glass with real wall thickness, foot and stem: one closed surface"},
       {"torus-knot", "a closed tube along the (2,3) torus knot, up to six layers deep"},
       {"nested-shells", "five bumpy closed shells inside each other, one part each"},
       {"coplanar-stack",
        "sheets that coincide exactly, share a plane, or are 1e-7 to 0.1 apart: z-fighting data"},
       {"bottles", "three bottles with wall thickness, liquid and an open label band, one part each"},
       {"hair", "1,500 curly strands in three shades, thin and deep"},
       {"smoke", "260 faint discs in all directions: fire below, soot and steam above"},
       {"shelf", "nine of the bottles in three rows behind each other"},
       {"greenhouse", "24 plants of 4,200 leaves and blossoms behind panes of glass"}}};
  return list;
}

std::vector<SamplePart> make_sample(const std::string& name, double detail) {
  if (!(detail >= 0.01 && detail <= 1000.0)) {
    throw Error(ErrorKind::bad_argument, "detail must be between 0.01 and 1000");
  }
  const std::span<const SampleInfo> list = sample_list();
  std::string known;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name == name) return kMakers[i](detail);
    known += (i == 0 ? "" : ", ") + list[i].name;
  }
  throw Error(ErrorKind::bad_argument, "unknown sample '" + name + "'; known samples: " + known);
}

}  // namespace pellucid
