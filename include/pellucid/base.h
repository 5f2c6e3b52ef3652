// pellucid/base.h - types and functions that every module uses.
//
// This header has vectors, errors, progress reporting, seeded random numbers, file access and process limits.
// It depends on nothing but the standard library.
//
// The whole library follows these conventions. Coordinates are right-handed, and lengths are in metres as in
// glTF. The corners of a front face run counter-clockwise when seen from the front. Positions are float32 and
// indices are uint32 in memory. Depth runs from 0 (near plane) to 1 (far plane). Directions are unit vectors
// in the object space of the mesh. Distances of viewpoints are in units of the bounding radius R
// (BoundingSphere in pellucid/mesh.h).
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

// Returns the unit vector along `a`, or the zero vector for a zero vector.
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

// A 4x4 matrix, stored by columns as in glTF: element (row, column) is m[4 * column + row].
struct Mat4 {
  std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  constexpr bool operator==(const Mat4&) const = default;
};

// ----------------------------------------------------------------------------------------------- errors

// What happened.
enum class ErrorKind {
  bad_argument,    // an argument or option has a value that the function does not accept
  bad_input,       // a file or a mesh is missing, truncated, malformed or inconsistent
  nothing_to_do,   // the input is valid but contains nothing to work on
  quality_missed,  // the result does not reach the requested quality
  cannot_write,    // a file cannot be written: no permission, disk full, another run holds the folder
  interrupted,     // the caller's Progress requested a stop
  internal,        // a bug in pellucid
};

// The only exception that public functions throw on purpose. what() is one line that names the file or the
// argument, the reason and, if there is one, the remedy: "bunny.ply: vertex 17 of 35947 is cut off (file ends
// at byte 812)".
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

// ---------------------------------------------------------------------------------- progress and time

// Reports the progress of long operations and lets the caller stop them. The library itself never prints: the
// caller derives from this class and decides what to show. Methods may be called from several threads at
// once.
class Progress {
 public:
  Progress() = default;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  virtual ~Progress() = default;

  // Announces that a stage named `name` begins. The arguments of the advance() calls that follow add up to
  // `total`. A `total` of 0 means that the amount of work is unknown.
  virtual void begin(std::string_view name, std::uint64_t total) = 0;
  // Announces that `amount` more of the stage's total is done.
  virtual void advance(std::uint64_t amount) = 0;
  // Passes on one line that the user should see while work goes on, for example that a damaged checkpoint is
  // computed again.
  virtual void note(std::string_view /*line*/) {}
  // Returns true once the caller wants to stop. The operation then soon throws Error{interrupted}.
  [[nodiscard]] virtual bool stop_requested() const { return false; }
};

// Throws Error{interrupted} if `progress` is not null and requests a stop.
void stop_if_requested(const Progress* progress);

// Call begin() and advance() unless `progress` is null.
inline void begin_stage(Progress* progress, std::string_view name, std::uint64_t total) {
  if (progress != nullptr) progress->begin(name, total);
}
inline void advance_stage(Progress* progress, std::uint64_t amount) {
  if (progress != nullptr) progress->advance(amount);
}

// Measures wall time since its construction.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  // Returns the seconds so far and restarts the measurement.
  double lap() {
    const double elapsed = seconds();
    start_ = std::chrono::steady_clock::now();
    return elapsed;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// ----------------------------------------------------------------------------------------------- random

// A pseudo-random generator, SplitMix64 (Steele, Lea, Flood, OOPSLA 2014). The same seed gives the same
// numbers on every platform, which the distributions of the standard library do not promise. The library
// never seeds it from a clock.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  // Returns 64 random bits.
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  // Returns a number that is uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }
  // Returns a number that is uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // Returns a number of 0 .. count - 1, where count > 0.
  std::uint64_t below(std::uint64_t count) { return next() % count; }
  // Returns the state. Random(state()) produces the same numbers that this generator would produce next.
  [[nodiscard]] std::uint64_t state() const { return state_; }
  // Returns a unit vector that is uniform on the sphere.
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

// Returns the whole content of a file. Throws Error{bad_input} that names the path and the reason: the file
// is missing, is a directory, may not be read, or is larger than `max_bytes`.
std::vector<std::byte> read_file(const std::string& path, std::uint64_t max_bytes = std::uint64_t{8} << 30U);

// Writes a file so that it appears complete or not at all: writes a temporary file beside `path`, flushes it
// to disk and renames it. The temporary file is removed if anything fails. Devices and pipes are written in
// place. Throws Error{cannot_write} that names the path and the reason.
void write_file_atomically(const std::string& path, std::span<const std::byte> bytes);
void write_file_atomically(const std::string& path, std::string_view text);

// ---------------------------------------------------------------------------------------------- process

// Returns the largest resident set of this process so far, in bytes, or 0 if the system does not report it.
std::uint64_t peak_rss_bytes();

// Limits the library to `threads` threads (0: all cores) while this object exists. Results do not depend on
// the number of threads.
class ThreadLimit {
 public:
  explicit ThreadLimit(unsigned threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

// --------------------------------------------------------------------------------------- images and numbers

// An image of 8 bits per channel.
struct Image {
  std::uint32_t width = 0, height = 0;  // pixels
  std::vector<std::uint8_t> rgb;        // 3 bytes per pixel, sRGB, rows from top to bottom
};

// Returns a number with a comma after every three digits: "12,345".
std::string format_count(std::uint64_t count);

// Returns the lines of a text without their ends. LF, CR and CRLF each end a line, and a byte order mark of
// UTF-8 is skipped.
std::vector<std::string> text_lines(std::string_view text);

}  // namespace pellucid
