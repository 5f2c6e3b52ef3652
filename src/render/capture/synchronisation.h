// synchronisation.h - which way of keeping fragments of a pixel apart a technique takes.
#pragma once

#include <cstdint>

#include "pellucid/render.h"

namespace pellucid::render {

// 128-bit attachments that hold k fragments of three words.
constexpr std::uint32_t ordered_attachments_for(std::uint32_t k) {
  return (3 * k + 3) / 4;
}

// What RenderOptions::sync means here; automatic: the technique has no choice. Throws Error{bad_argument}
// where the device has not what is asked for, or not enough of it.
Sync choose_sync(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device);

}  // namespace pellucid::render
