// Ways of keeping fragments of a pixel apart: what they are called, and what they need.
#include "pellucid/render.h"

namespace pellucid {

std::span<const NamedSync> sync_ways() {
  static const std::vector<NamedSync> kWays{{Sync::ordered, "ordered"},
                                            {Sync::interlock, "interlock"},
                                            {Sync::atomics, "atomics"},
                                            {Sync::atomics32, "atomics32"},
                                            {Sync::spinlock, "spinlock"}};
  return kWays;
}

std::string missing_for(Sync sync, const DeviceInfo& device) {
  if (sync == Sync::atomics && !device.atomics64) return "64-bit atomics";
  if (sync == Sync::interlock && !device.interlock) return "VK_EXT_fragment_shader_interlock";
  if (sync == Sync::ordered && device.ordered_attachments == 0)
    return "VK_EXT_rasterization_order_attachment_access";
  return "";
}

}  // namespace pellucid
