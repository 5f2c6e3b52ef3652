// pellucid/render.h - module `render`: captures all fragments of a pixel on the GPU and draws what an effect
// makes of them.
//
// In: triangles in world space with their objects and surfaces, a camera, the name of a capture technique and
// an effect (pellucid/render_options.h). Out: an image, and counts of what was captured. A capture technique
// delivers the fragments of every pixel in the order (depth, id), each once: all of them (exact) or a
// documented part; an effect folds them. Paper: Vasilakis, Fudos, "Depth-Fighting Aware Methods for
// Multi-Fragment Rendering", TVCG 2014.
//
// Conventions: depth is 0..1 forward, from near to far, in 32-bit floats (raster.h has the formula). Back
// faces are drawn where a surface is double-sided. Fragment ids are those of raster.h (NodeId: 2 * triangle +
// (1: back face)). Fragments of equal depth come in the order of their ids, so images do not depend on the
// draw order.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/render_options.h"
#include "pellucid/scene.h"

namespace pellucid {

// ------------------------------------------------------------------------------------------------ device

struct DeviceOptions {
  std::string device;     // part of its name, in any case; empty: a GPU before a driver that runs on the CPU
  bool validate = false;  // Vulkan and synchronisation validation; needs the layers
  std::uint64_t max_buffer_bytes = 0;  // limits what a shader addresses of a buffer; 0: the device's limit
  // For tests: called before each call of Vulkan that may fail, with the call's purpose. Where it returns a
  // VkResult other than 0, the call is not made and this is taken for its result.
  std::function<int(std::string_view what)> fault{};
  // Called with messages of validation, from any thread, also while the renderer is destroyed.
  std::function<void(const std::string&)> on_message{};
};

struct DeviceInfo {
  std::string name, driver;
  bool cpu = false;                    // a driver that runs on the CPU
  std::uint64_t max_buffer_bytes = 0;  // what a shader may address in one buffer
  std::uint32_t max_side = 0;          // of an image, in pixels
  bool atomics64 = false;              // 64-bit atomics on buffers
  bool layered = false;                // vertex shaders may choose the layer of an attachment
  bool precise_queries = false;        // occlusion queries count
  bool conditional = false;            // draws that depend on a query (VK_EXT_conditional_rendering)
  // Number of 128-bit attachments that fragment shaders can read in draw order
  // (VK_EXT_rasterization_order_attachment_access).
  std::uint32_t ordered_attachments = 0;
  bool interlock = false;  // critical sections of fragment shaders (VK_EXT_fragment_shader_interlock)
};

// ------------------------------------------------------------------------------------------------ results

struct CaptureStats {
  // Fragments that were rasterised in front of opaque surfaces, counted in a pass of its own.
  std::uint64_t fragments = 0;
  std::uint64_t captured = 0;    // of them, those that the effect was given
  std::uint64_t overflowed = 0;  // of them, those that found no place
  // Verified blending: pixels (or samples) where the draw order was not the order of depths.
  std::uint64_t repaired_pixels = 0;
  std::uint64_t repaired_triangles = 0;  // triangles that were drawn again for it
  // Ordered k-buffer: pixels (or samples) where a fragment came after more than k farther ones, and was
  // blended behind some of them. 0: all were blended in order, the image is exact.
  std::uint64_t misordered_pixels = 0;
  // Fragments did not fit: PoolOptions::overflow decided what became of them, or they were captured again.
  bool pool_exceeded = false;
  std::uint64_t coplanar = 0;  // captured fragments at the depth of another one of their pixel
  std::uint64_t coplanar_pixels = 0, covered_pixels = 0;  // samples, where a pixel has several
  std::uint64_t seen_pixels = 0;                          // with fragments in any sample
  std::uint64_t deepest_pixel = 0;                        // the largest number of fragments of a pixel
  // Slots for fragments of a covered pixel, of techniques with a tail: least, most, sum.
  std::optional<std::uint32_t> k_least, k_most;
  std::uint64_t k_sum = 0;
  Sync sync = Sync::automatic;  // the way that was chosen; automatic: the technique has no choice
  // Of `auto`: the technique that it took, and why; several where bands of an image differ.
  std::string chosen, reason;
  std::uint32_t rounds = 0;             // of techniques that peel
  std::uint32_t geometry_passes = 0;    // number of passes over all triangles
  std::uint32_t fullscreen_passes = 0;  // compute passes over the image
  double drawn_share = 1;               // of triangles x geometry passes, with PeelingOptions::cull
  std::uint64_t bytes = 0;              // of the technique's own buffers and images
  double milliseconds = 0;              // on the device, from the first clear to the finished image
  double resolve_milliseconds = 0;      // of them, sorting and folding what was captured
  [[nodiscard]] std::optional<double> k_mean() const {
    if (!k_least || covered_pixels == 0) return std::nullopt;
    return static_cast<double>(k_sum) / static_cast<double>(covered_pixels);
  }
  // The paper's robustness ratio R_h; 1 for an empty image.
  [[nodiscard]] double captured_share() const {
    return fragments == 0 ? 1 : static_cast<double>(captured) / static_cast<double>(fragments);
  }
};

struct CapturedFragments {
  std::vector<std::uint64_t> offsets;  // of every pixel (or, pixel by pixel, of every sample), and the end
  std::vector<Fragment> fragments;     // as they were delivered
  // Of each: linear colour, lit, and opacity; empty for techniques with a tail.
  std::vector<std::array<float, 4>> colors;
};

struct RenderResult {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3f> pixels;  // linear colour, row by row from the upper left
  CaptureStats stats;
  CapturedFragments fragments;
  BudgetMaps maps;  // with BudgetOptions::maps
};

struct OverdrawCount {
  std::uint64_t shaded = 0;   // fragments that a strict depth test lets through, in draw order
  std::uint64_t covered = 0;  // covered pixels, the least that `shaded` can be
};

// Draws the same on the CPU, from the fragments of raster.h: the oracle of all techniques. Colours are not
// rounded on the way, as those of fragments on the device are (8 bits a channel, gamma 2). CaptureStats has
// fragments, captured, coplanar, pixels and milliseconds. Throws as Renderer::draw does for effects, and for
// `samples` and `peeling.cull`, which it does not support.
RenderResult draw_reference(const RenderScene& scene, const Camera& camera, const RenderOptions& options);

// A device with one scene on it. Must not be used from several threads at once.
class Renderer {
 public:
  // Throws Error{bad_argument} where no device fits, and Error{internal} where the device fails, for example
  // because memory is exhausted on the device or on the host. After such an error, here or below, nothing of
  // what was begun is left, and the renderer can be used again, unless the device was lost: then every later
  // call throws.
  explicit Renderer(const DeviceOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  [[nodiscard]] const DeviceInfo& info() const;

  // Copies the scene to the device. Throws Error{bad_argument} for indices out of range, and for scenes that
  // a buffer of the device cannot hold.
  void load(const RenderScene& scene);

  // Draws what was loaded. Images whose buffers would be too large for the device are drawn in bands. Throws
  // Error{bad_argument} for a technique that does not exist or that the device does not support, and for
  // effects that the scene has too many objects for; Error{interrupted} when `progress` asks to stop.
  RenderResult draw(const Camera& camera, const RenderOptions& options, Progress* progress = nullptr);

  // Counts the fragments that would be shaded if all that was loaded were opaque, on the device, behind its
  // depth test: the oracle of metric.h's measure_overdraw and of overdraw.h. Double-sided surfaces are drawn
  // before the others. Throws as draw() does.
  OverdrawCount count_overdraw(const Camera& camera);

  // Returns the messages of validation so far, with DeviceOptions::validate.
  [[nodiscard]] std::vector<std::string> validation_messages() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pellucid
