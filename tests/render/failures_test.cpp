// Tests Vulkan calls that fail, at every place of a draw. Each gives one error that says what failed and
// leaks nothing, and the next image is right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <mutex>

#include "render_helpers.h"

namespace pellucid {
namespace {

using ::testing::HasSubstr;

constexpr int kOutOfHostMemory = -1;
constexpr int kOutOfDeviceMemory = -2;
constexpr int kDeviceLost = -4;

// Lets the n-th call fail, and remembers what validation says.
class Fault {
 public:
  DeviceOptions options() {
    return {.device = testing::test_renderer().info().name,
            .validate = testing::validation_is_on(),
            .fault = [this](std::string_view what) { return ask(what); },
            .on_message =
                [this](const std::string& message) {
                  const std::scoped_lock lock(mutex_);
                  messages_ += message + "\n";
                }};
  }
  // The n-th call from now on, from 0.
  void arm(int result, std::size_t n) {
    result_ = result;
    at_ = n;
    calls_ = 0;
    failed_.clear();
  }
  void disarm() { result_ = 0; }
  void restart_count() { calls_ = 0; }
  [[nodiscard]] std::size_t calls() const { return calls_; }
  [[nodiscard]] const std::string& failed() const {
    return failed_;
  }  // what the call was for; empty: none failed
  [[nodiscard]] std::string messages() const { return messages_; }

 private:
  int ask(std::string_view what) {
    if (result_ == 0 || calls_++ != at_) {
      calls_ += result_ == 0 ? 1 : 0;
      return 0;
    }
    failed_ = what;
    return result_;
  }

  int result_ = 0;
  std::size_t at_ = 0, calls_ = 0;
  std::string failed_, messages_;
  std::mutex mutex_;
};

// What an error says; empty: there was none.
template <class Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::internal);
    return error.what();
  }
  return "";
}

RenderScene translucent_and_opaque() {
  RenderScene scene = testing::joined(testing::random_stack(51, 20), testing::coplanar_squares(1, 0.75F));
  scene.surfaces.back().opaque = true;
  return scene;
}

TEST(Failures, EveryCallOfADraw) {
  Fault fault;
  {
    Renderer renderer(fault.options());
    renderer.load(translucent_and_opaque());
    const Camera camera = testing::unit_camera(12, 12);
    for (const RenderOptions& options : std::initializer_list<RenderOptions>{
             {.technique = "sb", .keep_fragments = true},
             {.technique = "sb", .pool = {.nodes = 100, .overflow = Overflow::exact}},
             {.technique = "kb"},
             {.technique = "f2b-2p", .peeling = {.cull = renderer.info().conditional}},
             {.technique = "f2b"},
             {.technique = "verified"},
             {.technique = "variable-k"}}) {
      if (options.pool.nodes != 0 && !renderer.info().atomics64) continue;
      fault.disarm();
      fault.restart_count();
      const std::vector<Vec3f> expected = renderer.draw(camera, options).pixels;
      fault.restart_count();
      renderer.draw(camera, options);  // with all pipelines made
      const std::size_t calls = fault.calls();
      ASSERT_GT(calls, 50U);
      for (std::size_t n = 0; n < calls; ++n) {
        fault.arm(n % 2 == 0 ? kOutOfDeviceMemory : kOutOfHostMemory, n);
        const std::string error = error_of([&] { renderer.draw(camera, options); });
        ASSERT_NE(fault.failed(), "") << options.technique << " " << n;
        ASSERT_THAT(error, HasSubstr("memory")) << options.technique << ", " << fault.failed();
        fault.disarm();
        if (n % 4 == 0) {
          ASSERT_EQ(renderer.draw(camera, options).pixels, expected) << "after " << fault.failed();
        }
      }
      ASSERT_EQ(renderer.draw(camera, options).pixels, expected);
    }
  }
  EXPECT_EQ(fault.messages(), "");
}

TEST(Failures, NamesWhatWasAskedFor) {
  Fault fault;
  Renderer renderer(fault.options());
  renderer.load(translucent_and_opaque());
  std::vector<std::string> errors;
  for (std::size_t n = 0; errors.empty() || fault.failed() != ""; ++n) {
    fault.arm(kOutOfDeviceMemory, n);
    errors.push_back(error_of([&] { renderer.draw(testing::unit_camera(12, 12), {.technique = "sb"}); }));
  }
  EXPECT_THAT(errors, ::testing::Contains(::testing::AllOf(HasSubstr("fragment pool"), HasSubstr("bytes"))));
  EXPECT_THAT(errors, ::testing::Contains(::testing::AllOf(HasSubstr("out of memory: the fragment pool"),
                                                           HasSubstr("bytes"))));
  EXPECT_THAT(errors, ::testing::Contains(HasSubstr("submitting")));
}

TEST(Failures, EveryCallOfLoading) {
  Fault fault;
  {
    Renderer renderer(fault.options());
    const Camera camera = testing::unit_camera(12, 12);
    renderer.load(translucent_and_opaque());
    const std::vector<Vec3f> expected = renderer.draw(camera, {.technique = "sb"}).pixels;
    for (std::size_t n = 0;; ++n) {
      fault.arm(kOutOfDeviceMemory, n);
      const std::string error = error_of([&] { renderer.load(translucent_and_opaque()); });
      fault.disarm();
      if (fault.failed().empty()) break;
      EXPECT_THAT(error, HasSubstr("memory"));
      // Half a scene is none.
      EXPECT_THROW(renderer.draw(camera, {.technique = "sb"}), Error);
    }
    EXPECT_EQ(renderer.draw(camera, {.technique = "sb"}).pixels, expected);
  }
  EXPECT_EQ(fault.messages(), "");
}

TEST(Failures, EveryCallOfMaking) {
  Fault fault;
  for (std::size_t n = 0;; ++n) {
    fault.arm(kOutOfHostMemory, n);
    const std::string error = error_of([&] { const Renderer renderer(fault.options()); });
    if (fault.failed().empty()) break;
    EXPECT_THAT(error, HasSubstr("memory"));
  }
  EXPECT_EQ(fault.messages(), "");
}

// Wherever it happens: nothing is drawn any more, nothing leaks, and another renderer works.
TEST(Failures, DeviceThatIsLost) {
  const Camera camera = testing::unit_camera(12, 12);
  for (const std::size_t n : {std::size_t{0}, std::size_t{9}, std::size_t{31}, std::size_t{60}}) {
    Fault fault;
    {
      Renderer renderer(fault.options());
      renderer.load(translucent_and_opaque());
      renderer.draw(camera, {.technique = "sb"});
      fault.arm(kDeviceLost, n);
      EXPECT_THAT(error_of([&] { renderer.draw(camera, {.technique = "sb"}); }), HasSubstr("lost")) << n;
      ASSERT_NE(fault.failed(), "");
      fault.disarm();
      EXPECT_THAT(error_of([&] { renderer.draw(camera, {.technique = "sb"}); }), HasSubstr("new Renderer"));
      EXPECT_THAT(error_of([&] { renderer.load(translucent_and_opaque()); }), HasSubstr("new Renderer"));
      EXPECT_THAT(error_of([&] { renderer.count_overdraw(camera); }), HasSubstr("new Renderer"));
    }
    EXPECT_EQ(fault.messages(), "");
  }
}

// Devices that let shaders address little: techniques with any kind of buffer draw the same, in bands.
TEST(Failures, SmallBuffersCutTheImageIntoBands) {
  const RenderScene scene = testing::random_stack(52, 24);
  const Camera camera = testing::unit_camera(16, 24);
  Renderer limited({.device = testing::test_renderer().info().name,
                    .validate = testing::validation_is_on(),
                    .max_buffer_bytes = 8000});
  EXPECT_EQ(limited.info().max_buffer_bytes, 8000U);
  limited.load(scene);
  testing::test_renderer().load(scene);
  for (const char* technique : {"sb", "bun-ll", "kb", "multikb", "bad", "f2b-2p", "dual-kb"}) {
    if (!limited.info().atomics64 && std::string(technique) != "sb") continue;
    const RenderOptions options{.technique = technique, .plain_resolve = true};
    const RenderResult expected = testing::test_renderer().draw(camera, options);
    const RenderResult result = limited.draw(camera, options);
    EXPECT_EQ(result.pixels, expected.pixels) << technique;
    EXPECT_EQ(result.stats.fragments, expected.stats.fragments) << technique;
    EXPECT_EQ(result.stats.captured, expected.stats.captured) << technique;
    EXPECT_EQ(result.stats.coplanar, expected.stats.coplanar) << technique;
  }
  EXPECT_TRUE(limited.validation_messages().empty());
}

// More than 8 bits show.
std::size_t different_pixels(const RenderResult& a, const RenderResult& b) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < a.pixels.size(); ++p)
    count += testing::difference(a.pixels[p], b.pixels[p]) > 0.004F ? 1U : 0U;
  return count;
}

// Opaque surfaces, marks and samples of each band for itself.
TEST(Failures, BandsHaveOpaqueSurfacesAndSamples) {
  RenderScene scene = testing::random_boxes(8, 10, 3);
  scene.surfaces[1].opaque = true;
  const Camera camera = look_at_sphere({{0.5, 0.5, 0.5}, 0.9}, {normalized(Vec3d{1, 2, 3}), 3}, 20, 27);
  Renderer limited({.device = testing::test_renderer().info().name,
                    .validate = testing::validation_is_on(),
                    .max_buffer_bytes = 12'000});
  limited.load(scene);
  testing::test_renderer().load(scene);
  for (const char* technique : {"sb", "f2b-3p", "verified"}) {
    for (const std::uint32_t samples : {1U, 4U}) {
      const RenderOptions options{
          .technique = technique, .effect = Effect::wireframe, .samples = samples, .plain_resolve = true};
      const RenderResult expected = testing::test_renderer().draw(camera, options);
      const RenderResult result = limited.draw(camera, options);
      // Windows of samples lie elsewhere in a band: depths are rounded otherwise, and fragments that touch an
      // opaque surface may fall to either side of it.
      const std::size_t most = samples == 1 ? 0 : expected.pixels.size() / 50;
      EXPECT_LE(different_pixels(result, expected), most) << technique << ' ' << samples;
      EXPECT_NEAR(static_cast<double>(result.stats.captured), static_cast<double>(expected.stats.captured),
                  static_cast<double>(most));
      EXPECT_GT(result.stats.geometry_passes, expected.stats.geometry_passes);
    }
  }
  EXPECT_TRUE(limited.validation_messages().empty());
}

// A row of pixels is the least that an image can be cut into.
TEST(Failures, BuffersForLessThanARowAreRefused) {
  Renderer limited({.device = testing::test_renderer().info().name, .max_buffer_bytes = 8000});
  limited.load(testing::coplanar_squares(80, 0.5F));
  try {
    limited.draw(testing::unit_camera(40, 40), {.technique = "sb"});
    FAIL() << "it was drawn";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_argument);
    EXPECT_THAT(error.what(), HasSubstr("lets shaders address"));
  }
}

}  // namespace
}  // namespace pellucid
