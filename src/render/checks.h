// checks.h - what is refused before anything is drawn: each throws Error{bad_argument} that says why.
#pragma once

#include "render/capture/technique.h"

namespace pellucid::render {

// By its name, where `device` has what it needs.
const TechniqueEntry& find_technique(const RenderOptions& options, const DeviceInfo& device);
void check_options(const Camera& camera, const RenderOptions& options, const DeviceInfo& device,
                   std::uint32_t objects);
void check_technique(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device);

// What RenderOptions::sync means here; automatic: the technique has no choice. Throws Error{bad_argument}
// where the device has not what is asked for, or not enough of it.
Sync choose_sync(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device);

}  // namespace pellucid::render
