// Synchronisation: see synchronisation.h.
#include "synchronisation.h"

#include <fmt/format.h>

namespace pellucid::render {
namespace {

// Why a way is not open; empty: it is.
std::string obstacle(Sync sync, const RenderOptions& options, const DeviceInfo& device) {
  if (sync == Sync::atomics)
    return device.atomics64 ? "" : "64-bit atomics, which " + device.name + " has not";
  if (sync == Sync::interlock)
    return device.interlock ? "" : "VK_EXT_fragment_shader_interlock, which " + device.name + " has not";
  if (device.ordered_attachments == 0)
    return "VK_EXT_rasterization_order_attachment_access, which " + device.name + " has not";
  if (ordered_attachments_for(options.k) <= device.ordered_attachments) return "";
  return fmt::format("{} attachments for --k {}, and {} has {}", ordered_attachments_for(options.k),
                     options.k, device.name, device.ordered_attachments);
}

std::string name_of(Sync sync) {
  return sync == Sync::ordered ? "ordered" : sync == Sync::interlock ? "interlock" : "atomics";
}

}  // namespace

Sync choose_sync(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device) {
  if (!technique.synchronised) return Sync::automatic;
  if (options.sync == Sync::automatic) {
    for (const Sync sync : {Sync::ordered, Sync::interlock})
      if (obstacle(sync, options, device).empty()) return sync;
  }
  const Sync wanted = options.sync == Sync::automatic ? Sync::atomics : options.sync;
  const std::string reason = obstacle(wanted, options, device);
  if (!reason.empty())
    throw Error(ErrorKind::bad_argument, fmt::format("--sync {} needs {}", name_of(wanted), reason));
  return wanted;
}

}  // namespace pellucid::render
