// pellucid/render.h - module `render`: captures all fragments of every pixel on the GPU and draws an effect
// from them.
//
// In: triangles in world space with their objects and surfaces (RenderScene of pellucid/scene.h), a camera,
// the name of a capture technique, and an effect (pellucid/render_options.h). Out: an image, and counts of
// what was captured. A capture technique delivers the fragments of every pixel in the order (depth, id), each
// once. An exact technique delivers all of them, others a documented part. An effect folds the fragments into
// a colour.
//
// Based on: Vasilakis, Fudos, "Depth-Fighting Aware Methods for Multi-Fragment Rendering", TVCG 2014.
//
// Conventions: depth runs from 0 (near plane) to 1 (far plane), in 32-bit floats (raster.h has the formula).
// Back faces are drawn if a surface is double-sided. Fragment ids are the nodes of raster.h: 2 * triangle +
// (1: back face). Fragments of equal depth are ordered by their ids, so images do not depend on the draw
// order.
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
  std::string device;                  // part of its name, upper or lower case; empty: a GPU if there is one
  bool validate = false;               // with Vulkan and synchronisation validation, which needs the layers
  std::uint64_t max_buffer_bytes = 0;  // limit for one buffer; 0: the limit of the device
  // For tests: called before each Vulkan call that may fail, with the purpose of the call. If it returns a
  // VkResult other than 0, the call is not made, and the value is used as its result.
  std::function<int(std::string_view what)> fault{};
  // Called with validation messages, from any thread, also while the renderer is destroyed.
  std::function<void(const std::string&)> on_message{};
};

struct DeviceInfo {
  std::string name, driver;
  bool cpu = false;                    // the driver runs on the CPU
  std::uint64_t max_buffer_bytes = 0;  // the largest buffer that a shader may address
  std::uint32_t max_side = 0;          // the longest side of an image, pixels
  bool atomics64 = false;              // 64-bit atomics on buffers
  bool layered = false;                // vertex shaders may choose the layer of an attachment
  bool precise_queries = false;        // occlusion queries count samples
  bool conditional = false;            // draws that depend on a query (VK_EXT_conditional_rendering)
  // The number of 128-bit attachments that fragment shaders can read in draw order
  // (VK_EXT_rasterization_order_attachment_access).
  std::uint32_t ordered_attachments = 0;
  bool interlock = false;  // critical sections of fragment shaders (VK_EXT_fragment_shader_interlock)
};

// ------------------------------------------------------------------------------------------------ results

struct CaptureStats {
  // The number of fragments in front of opaque surfaces, counted in a pass of its own.
  std::uint64_t fragments = 0;
  std::uint64_t captured = 0;    // those that the effect was given
  std::uint64_t overflowed = 0;  // those that found no place
  // Verified blending: pixels (or samples) in which the draw order differed from the depth order.
  std::uint64_t repaired_pixels = 0;
  std::uint64_t repaired_triangles = 0;  // triangles that were drawn again for them
  // Ordered k-buffer: pixels (or samples) in which a fragment came after more than k farther ones and was
  // blended behind some of them. If 0, all fragments were blended in order, and the image is exact.
  std::uint64_t misordered_pixels = 0;
  // Set if fragments did not fit. Then PoolOptions::overflow decided what was done with them, or they were
  // captured again.
  bool pool_exceeded = false;
  std::uint64_t coplanar = 0;  // captured fragments at the depth of another one in their pixel
  std::uint64_t coplanar_pixels = 0, covered_pixels = 0;  // counts samples if a pixel has several
  std::uint64_t seen_pixels = 0;                          // pixels with fragments in any sample
  std::uint64_t deepest_pixel = 0;                        // the largest number of fragments of a pixel
  // Techniques with a tail: the least and largest number of slots for fragments of a covered pixel, and the
  // sum over all of them.
  std::optional<std::uint32_t> k_least, k_most;
  std::uint64_t k_sum = 0;
  Sync sync = Sync::automatic;  // the way that was used; automatic: the technique has no choice
  // For `auto`: the technique that it chose, and why; several if bands of an image differ.
  std::string chosen, reason;
  std::uint32_t rounds = 0;             // for techniques that peel
  std::uint32_t geometry_passes = 0;    // number of passes over all triangles
  std::uint32_t fullscreen_passes = 0;  // compute passes over the image
  double drawn_share = 1;               // with PeelingOptions::cull: drawn share of triangles x passes
  std::uint64_t bytes = 0;              // buffers and images of the technique
  double milliseconds = 0;              // device time from the first clear to the finished image
  double resolve_milliseconds = 0;      // of this, sorting and folding what was captured
  // Returns the mean number of slots of a covered pixel; nothing for techniques without a tail.
  [[nodiscard]] std::optional<double> k_mean() const {
    if (!k_least || covered_pixels == 0) return std::nullopt;
    return static_cast<double>(k_sum) / static_cast<double>(covered_pixels);
  }
  // Returns the robustness ratio R_h of the paper; 1 for an empty image.
  [[nodiscard]] double captured_share() const {
    return fragments == 0 ? 1 : static_cast<double>(captured) / static_cast<double>(fragments);
  }
};

struct CapturedFragments {
  std::vector<std::uint64_t> offsets;  // first fragment of every pixel (or sample), and the end
  std::vector<Fragment> fragments;     // in the order in which they were delivered
  // For each fragment: linear lit colour and opacity. Empty for techniques with a tail.
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

// Draws the same on the CPU, from the fragments of raster.h. It is the reference for all techniques. Its
// colours are not rounded, unlike those of fragments on the device (8 bits per channel, gamma 2).
// CaptureStats has fragments, captured, coplanar, pixels and milliseconds. Throws as Renderer::draw() does
// for effects, and for `samples` and `peeling.cull`, which it does not support.
RenderResult draw_reference(const RenderScene& scene, const Camera& camera, const RenderOptions& options);

// A device with one scene on it. It must not be used from several threads at once.
class Renderer {
 public:
  // Throws Error{bad_argument} if no device fits, and Error{internal} if the device fails, for example
  // because memory is exhausted on the device or on the host. After such an error, here or below, nothing
  // that was begun remains, and the renderer can be used again. The exception is a lost device: then every
  // later call throws.
  explicit Renderer(const DeviceOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  [[nodiscard]] const DeviceInfo& info() const;

  // Copies the scene to the device. Throws Error{bad_argument} for indices out of range, and for scenes that
  // do not fit into a buffer of the device.
  void load(const RenderScene& scene);

  // Draws what was loaded. Images whose buffers would be too large for the device are drawn in bands. Throws
  // Error{bad_argument} for a technique that does not exist or that the device does not support, and for an
  // effect that does not support as many objects as the scene has. Throws Error{interrupted} if `progress`
  // asks to stop.
  RenderResult draw(const Camera& camera, const RenderOptions& options, Progress* progress = nullptr);

  // Counts the fragments that the device would shade behind its depth test if everything that was loaded were
  // opaque. It is the reference for measure_overdraw() of metric.h and for overdraw.h. Double-sided surfaces
  // are drawn before the others. Throws as draw() does.
  OverdrawCount count_overdraw(const Camera& camera);

  // Returns the validation messages so far, if DeviceOptions::validate is set.
  [[nodiscard]] std::vector<std::string> validation_messages() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pellucid
