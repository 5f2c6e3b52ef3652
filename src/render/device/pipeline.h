// pipeline.h - makes graphics and compute pipelines. Embedded shaders and specialisation constants go in,
// pipelines come out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "render/device/context.h"

namespace pellucid::render {

// Returns the SPIR-V of a shader by its path below shaders/ ("capture/count.frag"), with the suffix of its
// form (cmake/PellucidShaders.cmake). It is compiled at build time.
std::span<const std::uint32_t> shader_code(std::string_view name);
std::span<const std::string_view> shader_names();

class OrderedLayout;

// Specialisation constants 0, 1, 2, ... of a shader.
using Constants = std::vector<std::uint32_t>;

enum class Blend { none, max, add, under };  // under: dst + (1 - dst.a) src
// The format that Blend::under accumulates: premultiplied colours, front to back, and 1 - transmittance.
constexpr VkFormat kBlended = VK_FORMAT_R32G32B32A32_SFLOAT;
enum class DepthTest { none, less, less_or_equal, equal, greater };
enum class Stencil {
  none,
  route,   // passes where the stencil is 2, and then decrements it whether it passed or not
  mark,    // counts the fragments that fail the depth test
  marked,  // passes where the stencil is not 0
};

struct GraphicsSpec {
  std::string_view fragment_shader;  // empty: depth only
  Constants constants;
  std::vector<VkFormat> colors;
  Blend blend = Blend::none;
  VkFormat depth = VK_FORMAT_UNDEFINED;
  DepthTest depth_test = DepthTest::none;
  bool depth_write = false;
  std::string_view vertex_shader = "scene/scene.vert";
  Stencil stencil = Stencil::none;
  bool clamp_depth = false;                // instead of clipping at the near and far planes
  const OrderedLayout* ordered = nullptr;  // the colours are ordered attachments
};

// Two pipelines over the triangles of a scene: one draws both sides, the other culls back faces.
struct ScenePipeline {
  OwnedPipeline two_sided, culled;
};
ScenePipeline make_scene_pipeline(Context& context, const GraphicsSpec& spec);
OwnedPipeline make_compute_pipeline(Context& context, std::string_view shader, const Constants& constants);
OwnedPipeline make_compute_pipeline(Context& context, std::span<const std::uint32_t> code,
                                    const Constants& constants);

}  // namespace pellucid::render
