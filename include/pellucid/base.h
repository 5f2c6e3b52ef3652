// pellucid/base.h - what every module shares: vectors, errors, progress and seeded random numbers.
//
// Conventions of the whole library: right-handed, counter-clockwise front faces, metres as in glTF,
// depth 0..1 forward, float32 positions, uint32 indices in memory. Directions are unit vectors in the
// mesh's own (object) space. Distances of viewpoints are in units of the bounding radius R.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace pellucid {

// ---------------------------------------------------------------------------------------------- vectors

template <class Real>
struct Vec3 {
  Real x{}, y{}, z{};

  constexpr Vec3 operator+(const Vec3& b) const { return {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3 operator-(const Vec3& b) const { return {x - b.x, y - b.y, z - b.z}; }
  constexpr Vec3 operator-() const { return {-x, -y, -z}; }
  constexpr Vec3 operator*(Real s) const { return {x * s, y * s, z * s}; }
  constexpr Vec3 operator/(Real s) const { return {x / s, y / s, z / s}; }
  constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  constexpr bool operator==(const Vec3&) const = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class Real>
constexpr Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class Real>
constexpr Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Real>
Real length(const Vec3<Real>& a) {
  return std::sqrt(dot(a, a));
}

// The zero vector stays zero.
template <class Real>
Vec3<Real> normalized(const Vec3<Real>& a) {
  const Real l = length(a);
  return l > Real(0) ? a / l : a;
}

constexpr Vec3d to_double(const Vec3f& a) {
  return {a.x, a.y, a.z};
}
constexpr Vec3f to_float(const Vec3d& a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

// Column-major 4x4 matrix, as in glTF: element (row, column) is m[4 * column + row].
struct Mat4 {
  std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  constexpr bool operator==(const Mat4&) const = default;
};

// ----------------------------------------------------------------------------------------------- errors

enum class ErrorKind {
  bad_argument,    // the caller asked for something that makes no sense        (exit code 2)
  bad_input,       // a file is truncated, hostile, or not what it claims to be (exit code 3)
  nothing_to_do,   // valid input without anything to work on                   (exit code 4)
  quality_missed,  // the asked-for quality was not reached                     (exit code 5)
  cannot_write,    // no permission, disk full                                  (exit code 1)
  interrupted,     // the caller's Progress said stop                           (exit code 130)
  internal,        // a bug in pellucid                                         (exit code 1)
};

// Thrown at the public surface only. what() is one line that names the file or argument, the reason and,
// where there is one, the remedy: "bunny.ply: vertex 17 of 35947 is cut off (file ends at byte 812)".
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

// ---------------------------------------------------------------------------------- progress and time

// How long work tells of itself, and how it is told to stop. The library never prints; the command line
// derives from this. Methods may be called from several threads at once.
class Progress {
 public:
  Progress() = default;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  virtual ~Progress() = default;

  // A stage named `name` begins; `advance` will be called until its arguments sum up to `total`.
  // `total` = 0: the amount of work is not known.
  virtual void begin(std::string_view name, std::uint64_t total) = 0;
  virtual void advance(std::uint64_t amount) = 0;
  // One line that the user should know of while work goes on, such as a damaged record that is made anew.
  virtual void note(std::string_view /*line*/) {}
  // True once the caller wants to stop: the work then ends soon with Error{interrupted}.
  [[nodiscard]] virtual bool stop_requested() const { return false; }
};

// Throw Error{interrupted} when `progress` (may be null) asks for a stop.
void stop_if_requested(const Progress* progress);

// Null-safe shorthands.
inline void begin_stage(Progress* progress, std::string_view name, std::uint64_t total) {
  if (progress != nullptr) progress->begin(name, total);
}
inline void advance_stage(Progress* progress, std::uint64_t amount) {
  if (progress != nullptr) progress->advance(amount);
}

// Wall time since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  // The seconds so far; then it starts anew.
  double lap() {
    const double elapsed = seconds();
    start_ = std::chrono::steady_clock::now();
    return elapsed;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// ----------------------------------------------------------------------------------------------- random

// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): small, seeded, the same on every platform; std::
// distributions are not. Never seeded from a clock.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  // Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }
  // Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // Uniform in 0 .. count - 1; count > 0.
  std::uint64_t below(std::uint64_t count) { return next() % count; }
  // Random(state()) goes on where this one is.
  [[nodiscard]] std::uint64_t state() const { return state_; }
  // Uniform on the unit sphere.
  Vec3d direction() {
    const double z = uniform(-1.0, 1.0);
    const double phi = uniform(0.0, 6.283185307179586);
    const double r = std::sqrt(std::fmax(0.0, 1.0 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::uint64_t state_;
};

// ------------------------------------------------------------------------------------------------ files

// The whole of a file. Throws Error{bad_input} naming the path and the system's reason (missing, a directory,
// no permission, larger than `max_bytes`).
std::vector<std::byte> read_file(const std::string& path, std::uint64_t max_bytes = std::uint64_t{8} << 30U);

// Write through a temporary file beside `path`, flush it to disk, then rename: the file appears whole or not
// at all, and the temporary is gone whatever happens. Throws Error{cannot_write} naming the path and the
// reason.
void write_file_atomically(const std::string& path, std::span<const std::byte> bytes);
void write_file_atomically(const std::string& path, std::string_view text);

// ---------------------------------------------------------------------------------------------- process

// Largest resident set of this process so far, in bytes (0 where the system does not say).
std::uint64_t peak_rss_bytes();

// Limit the library's parallelism to `threads` (0: all cores) while this object lives. Results never
// depend on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(unsigned threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // 3 bytes a pixel, sRGB, upper row first
};

std::string format_count(std::uint64_t count);  // 12,345

}  // namespace pellucid
