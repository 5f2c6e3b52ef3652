// checks.h - finds techniques, and checks options before anything is drawn. Each check throws
// Error{bad_argument} that says what is wrong.
#pragma once

#include "render/capture/technique.h"

namespace pellucid::render {

// Returns the technique of that name. Throws if there is none, or if `device` does not support what it needs.
const TechniqueEntry& find_technique(const RenderOptions& options, const DeviceInfo& device);
void check_options(const Camera& camera, const RenderOptions& options, const DeviceInfo& device,
                   std::uint32_t objects);
void check_technique(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device);

// Returns the way of synchronisation that a technique uses with these options, or `automatic` if it has no
// choice. Throws if the device does not support the requested way, or does not have enough attachments.
Sync choose_sync(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device);

}  // namespace pellucid::render
