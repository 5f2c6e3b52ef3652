// Implements wrapper.h, which all functions of the C interface share: errors and version, views of the
// caller's arrays, and progress.
#include "c/wrapper.h"

#include <cmath>
#include <new>
#include <span>
#include <stdexcept>

namespace pellucid::c {
namespace {

// An array instead of a string, because it must not need memory when memory has run out.
thread_local char last_error[1024] = "";

constexpr std::chrono::milliseconds kProgressInterval{20};

PellucidStatus status_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::bad_argument:
      return pellucid_bad_argument;
    case ErrorKind::bad_input:
      return pellucid_bad_input;
    case ErrorKind::nothing_to_do:
      return pellucid_nothing_to_do;
    case ErrorKind::cannot_write:
      return pellucid_cannot_write;
    case ErrorKind::interrupted:
      return pellucid_cancelled;
    case ErrorKind::quality_missed:
    case ErrorKind::internal:
      break;
  }
  return pellucid_internal;
}

PositionView view_of_positions(const float* positions, const PellucidMesh& mesh) {
  if (mesh.position_stride == 0) return {positions, mesh.vertex_count};
  return {positions, mesh.vertex_count, mesh.position_stride};
}

}  // namespace

PellucidStatus fail(PellucidStatus status, const char* text) noexcept {
  std::strncpy(last_error, text, sizeof last_error - 1);
  return status;
}

PellucidStatus fail_with_current_exception() noexcept {
  try {
    throw;
  } catch (const Error& error) {
    return fail(status_of(error.kind()), error.what());
  } catch (const std::bad_alloc&) {
    return fail(pellucid_out_of_memory, "there is not enough memory");
  } catch (const std::length_error&) {
    return fail(pellucid_out_of_memory, "an array is larger than memory can be");
  } catch (const std::exception& error) {
    return fail(pellucid_internal, error.what());
  } catch (...) {
    return fail(pellucid_internal, "an unknown failure");
  }
}

// --------------------------------------------------------------------------------------- the caller's arrays

IndexView view_of_indices(const void* indices, std::uint32_t index_bytes, std::uint64_t count) {
  require(index_bytes == 2 || index_bytes == 4, "index_bytes must be 2 or 4");
  require(indices != nullptr || count == 0, "indices is null");
  if (index_bytes == 4) return std::span(static_cast<const std::uint32_t*>(indices), count);
  return std::span(static_cast<const std::uint16_t*>(indices), count);
}

MeshView view_of(const PellucidMesh* mesh) {
  require(mesh != nullptr, "mesh is null");
  return {view_of_positions(mesh->positions, *mesh),
          view_of_indices(mesh->indices, mesh->index_bytes, std::uint64_t{3} * mesh->triangle_count)};
}

std::vector<Pose> poses_of(const PellucidMesh& mesh, const PellucidPoses* poses) {
  if (poses == nullptr) return {};
  require(poses->frame_count > 0 && poses->positions != nullptr && poses->times != nullptr,
          "poses: there are no frames, or no times");
  std::vector<Pose> views;
  for (std::uint32_t frame = 0; frame < poses->frame_count; ++frame) {
    const float time = poses->times[frame];
    require(std::isfinite(time) && (frame == 0 || time > poses->times[frame - 1]),
            "poses: times must be finite and strictly increasing");
    views.push_back({time, view_of_positions(poses->positions[frame], mesh)});
  }
  return views;
}

Facing facing_of(PellucidFacing facing) {
  require(facing == pellucid_facing_single || facing == pellucid_facing_duplicated,
          "facing: there is no such value");
  return facing == pellucid_facing_single ? Facing::single : Facing::duplicated;
}

// -------------------------------------------------------------------------------------------------- progress

void CallbackProgress::begin(std::string_view name, std::uint64_t total) {
  const std::lock_guard lock(mutex_);
  stage_ = name;
  done_ = 0;
  total_ = total;
  tell();
}

void CallbackProgress::advance(std::uint64_t amount) {
  done_ += amount;
  // If another thread holds the lock, it is calling the caller's function now. Do not wait for it.
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && std::chrono::steady_clock::now() - last_told_ >= kProgressInterval) tell();
}

void CallbackProgress::tell() {
  if (stopped_) return;
  if (run_.progress(run_.user, stage_.c_str(), done_, total_) != 0) stopped_ = true;
  last_told_ = std::chrono::steady_clock::now();
}

}  // namespace pellucid::c

const char* pellucid_last_error(void) {
  return pellucid::c::last_error;
}

const char* pellucid_version(void) {
  return PELLUCID_VERSION;
}
