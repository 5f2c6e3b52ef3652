// Makes scenes with coincident surfaces, and computes their fragments on the CPU.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/render.h"

namespace pellucid::testing {

// The device that all tests of a program share, with validation on where the layers are there.
Renderer& test_renderer();
bool validation_is_on();
// What validation complained of first, in this process; empty: of nothing.
std::string first_validation_message();

// Names of techniques, for tests of each, and names of such tests.
std::vector<std::string> techniques_that(const std::function<bool(const TechniqueInfo&)>& wanted);
std::string technique_test_name(const ::testing::TestParamInfo<std::string>& parameter);

// Random small triangles in 0..1^3, in layers at dyadic depths, some of them several times.
RenderScene random_stack(std::uint64_t seed, std::size_t triangles);
// `copies` squares of two triangles each over the whole image, at one depth.
RenderScene coplanar_squares(std::uint32_t copies, float depth);
// One closed box, one object.
RenderScene closed_box(const Vec3f& low, const Vec3f& high);
// Closed boxes with corners on a grid, so that many faces coincide; each belongs to one of `objects` objects.
RenderScene random_boxes(std::uint64_t seed, std::size_t boxes, std::uint32_t objects);
// Two scenes as one; the second's objects after the first's.
RenderScene joined(const RenderScene& a, const RenderScene& b);
// Of a mesh, as one object.
RenderScene scene_of(const Mesh& mesh);

// Looks along +z at the unit cube, without perspective: positions on a grid of 1 / 256 pixel are where the
// CPU raster sees them, and depths of dyadic numbers are exact.
Camera unit_camera(std::uint32_t width, std::uint32_t height);

// The oracle: all fragments of the scene.
FragmentBuffer cpu_fragments(const RenderScene& scene, const Camera& camera);

// The largest of a channel, and of all pixels.
float difference(const Vec3f& a, const Vec3f& b);
float largest_difference(const RenderResult& a, const RenderResult& b);
// A fold ends where less than 1/16,384 gets through, blending in hardware does not.
constexpr float kFoldRounding = 1.0F / 16384 + 2e-6F;

// The same depths and ids in the same order.
bool same_fragments(std::span<const Fragment> a, std::span<const Fragment> b);

// Fragments of a pixel, coincident ones by their ids.
std::vector<Fragment> pixel_of(const CapturedFragments& captured, std::size_t pixel);

}  // namespace pellucid::testing
