// Implements the last section of pellucid/metric.h: measures the differences of two images by PSNR, flicker,
// structural similarity and colour distance.
#include <algorithm>
#include <array>
#include <cmath>

#include "pellucid/metric.h"

namespace pellucid {

namespace {

// The difference that is visible in an image of 8 bits per channel.
constexpr double kStep = 1.0 / 255;
// Differences of this many steps or more have the darkest red.
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

// ------------------------------------------------------------------------------------------- perceived error

namespace {

using Values = std::vector<double>;

// A separable Gaussian. Pixels outside the image repeat its border.
class Blur {
 public:
  Blur(std::uint32_t width, std::uint32_t height, double sigma, int radius)
      : width_(width), height_(height), radius_(radius) {
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
      weights_.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
      sum += weights_.back();
    }
    for (double& weight : weights_) weight /= sum;
  }
  [[nodiscard]] Values operator()(const Values& plane) const { return along(along(plane, 1, 0), 0, 1); }

 private:
  [[nodiscard]] Values along(const Values& plane, int dx, int dy) const {
    Values out(plane.size());
    const auto width = static_cast<int>(width_);
    const auto height = static_cast<int>(height_);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0;
        for (int i = -radius_; i <= radius_; ++i) {
          const int at_x = std::clamp(x + i * dx, 0, width - 1);
          const int at_y = std::clamp(y + i * dy, 0, height - 1);
          sum += weights_[static_cast<std::size_t>(i) + static_cast<std::size_t>(radius_)] *
                 plane[static_cast<std::size_t>(at_y) * width_ + static_cast<std::size_t>(at_x)];
        }
        out[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)] = sum;
      }
    }
    return out;
  }

  std::uint32_t width_, height_;
  int radius_;
  std::vector<double> weights_;
};

Values luma_of(std::span<const Vec3f> linear) {
  Values luma;
  luma.reserve(linear.size());
  for (const Vec3f& c : linear) {
    luma.push_back(0.2126 * srgb_from_linear(double{c.x}) + 0.7152 * srgb_from_linear(double{c.y}) +
                   0.0722 * srgb_from_linear(double{c.z}));
  }
  return luma;
}

Values product(const Values& a, const Values& b) {
  Values out(a.size());
  std::transform(a.begin(), a.end(), b.begin(), out.begin(), std::multiplies<>());
  return out;
}

// Returns the CIELAB colour of a linear sRGB colour, with the white point D65.
std::array<double, 3> lab_of(double r, double g, double b) {
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.950470);
  const double y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const double z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.088830);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

std::array<Values, 3> blurred_channels(std::span<const Vec3f> linear, const Blur& blur) {
  std::array<Values, 3> channels;
  for (const Vec3f& c : linear) {
    channels[0].push_back(std::clamp(double{c.x}, 0.0, 1.0));
    channels[1].push_back(std::clamp(double{c.y}, 0.0, 1.0));
    channels[2].push_back(std::clamp(double{c.z}, 0.0, 1.0));
  }
  for (Values& channel : channels) channel = blur(channel);
  return channels;
}

double ssim_of(const Values& a, const Values& b, const Blur& blur, double covered) {
  constexpr double kC1 = 0.01 * 0.01;
  constexpr double kC2 = 0.03 * 0.03;
  const Values mean_a = blur(a);
  const Values mean_b = blur(b);
  const Values square_a = blur(product(a, a));
  const Values square_b = blur(product(b, b));
  const Values mixed = blur(product(a, b));
  double missing = 0;
  for (std::size_t p = 0; p < a.size(); ++p) {
    const double ma = mean_a[p];
    const double mb = mean_b[p];
    const double spread = square_a[p] - ma * ma + square_b[p] - mb * mb;
    const double together = mixed[p] - ma * mb;
    missing += 1 - (2 * ma * mb + kC1) * (2 * together + kC2) / ((ma * ma + mb * mb + kC1) * (spread + kC2));
  }
  return 1 - missing / covered;
}

}  // namespace

PerceivedError perceived_error(std::span<const Vec3f> exact, std::span<const Vec3f> drawn,
                               std::uint32_t width, std::uint32_t height, std::uint64_t covered_pixels) {
  PerceivedError error;
  if (covered_pixels == 0) return error;
  const auto covered = static_cast<double>(covered_pixels);
  error.ssim = ssim_of(luma_of(exact), luma_of(drawn), Blur(width, height, 1.5, 5), covered);
  const Blur blur(width, height, 1, 3);
  const std::array<Values, 3> a = blurred_channels(exact, blur);
  const std::array<Values, 3> b = blurred_channels(drawn, blur);
  double sum = 0;
  for (std::size_t p = 0; p < exact.size(); ++p) {
    const auto lab_a = lab_of(a[0][p], a[1][p], a[2][p]);
    const auto lab_b = lab_of(b[0][p], b[1][p], b[2][p]);
    sum += std::abs(lab_a[0] - lab_b[0]) + std::hypot(lab_a[1] - lab_b[1], lab_a[2] - lab_b[2]);
  }
  error.hyab = sum / covered;
  return error;
}

}  // namespace pellucid
