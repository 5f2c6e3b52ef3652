// How far a captured picture is from the exact one: see pellucid/compare_report.h.
#include <algorithm>
#include <array>
#include <cmath>

#include "pellucid/metric.h"

namespace pellucid {
namespace {

// What can be told apart in a picture of 8 bits a channel.
constexpr double kStep = 1.0 / 255;
// Steps that are as dark red as any more.
constexpr double kMostColorSteps = 64;

std::array<double, 3> encoded(const Vec3f& linear) {
  return {srgb_from_linear(double{linear.x}), srgb_from_linear(double{linear.y}),
          srgb_from_linear(double{linear.z})};
}

std::array<std::uint8_t, 3> difference_color(int steps) {
  if (steps == 0) return {255, 255, 255};
  constexpr std::array<double, 3> kPale{253, 224, 200};
  constexpr std::array<double, 3> kDark{140, 10, 40};
  const double t = std::min(1.0, std::sqrt(steps / kMostColorSteps));
  std::array<std::uint8_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c)
    color.at(c) = static_cast<std::uint8_t>(std::lround(std::lerp(kPale.at(c), kDark.at(c), t)));
  return color;
}

}  // namespace

ImageError image_error(std::span<const Vec3f> exact, std::span<const Vec3f> drawn,
                       std::uint64_t covered_pixels) {
  ImageError error;
  FrameError sum;
  sum.foreground = covered_pixels;
  for (std::size_t p = 0; p < std::min(exact.size(), drawn.size()); ++p) {
    const std::array<double, 3> a = encoded(exact[p]);
    const std::array<double, 3> b = encoded(drawn[p]);
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = std::abs(a.at(c) - b.at(c));
      sum.squared_error += difference * difference;
      largest = std::max(largest, difference);
    }
    error.differing += largest > kStep ? 1U : 0U;
    error.largest = std::max(error.largest, largest);
  }
  error.psnr = sum.psnr();
  return error;
}

void Flicker::add(std::span<const Vec3f> exact, std::span<const Vec3f> drawn, std::uint64_t covered_pixels) {
  std::vector<float> error;
  error.reserve(3 * exact.size());
  for (std::size_t p = 0; p < std::min(exact.size(), drawn.size()); ++p) {
    const std::array<double, 3> a = encoded(exact[p]);
    const std::array<double, 3> b = encoded(drawn[p]);
    for (std::size_t c = 0; c < 3; ++c) error.push_back(static_cast<float>(b.at(c) - a.at(c)));
  }
  if (error.size() == error_.size()) {
    double change = 0;
    for (std::size_t i = 0; i < error.size(); ++i) change += std::abs(double{error[i]} - double{error_[i]});
    sum_ += change / kStep / (3 * static_cast<double>(std::max<std::uint64_t>(covered_pixels, 1)));
    ++steps_;
  }
  error_ = std::move(error);
}

std::optional<double> Flicker::mean() const {
  return steps_ == 0 ? std::nullopt : std::optional(sum_ / static_cast<double>(steps_));
}

Image difference_image(const Image& exact, const Image& drawn) {
  Image image{exact.width, exact.height, {}};
  image.rgb.reserve(exact.rgb.size());
  for (std::size_t i = 0; i + 2 < std::min(exact.rgb.size(), drawn.rgb.size()); i += 3) {
    int steps = 0;
    for (std::size_t c = 0; c < 3; ++c)
      steps = std::max(steps, std::abs(int{exact.rgb[i + c]} - int{drawn.rgb[i + c]}));
    for (const std::uint8_t value : difference_color(steps)) image.rgb.push_back(value);
  }
  return image;
}

}  // namespace pellucid
