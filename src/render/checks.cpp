// Implements checks.h: the list of techniques, and what is refused before anything is drawn.
#include "render/checks.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/capture/registry.h"
#include "render/device/ordered_attachments.h"
#include "render/options.h"

namespace pellucid {

std::span<const TechniqueInfo> render_techniques() {
  static const std::vector<TechniqueInfo> kInfos = [] {
    std::vector<TechniqueInfo> list;
    for (const render::TechniqueEntry& entry : render::technique_entries()) list.push_back(entry.info);
    return list;
  }();
  return kInfos;
}

std::string missing_for(const TechniqueInfo& technique, const DeviceInfo& device) {
  if (technique.needs_atomics64 && !device.atomics64) return "64-bit atomics on buffers";
  const auto is_there = [&](Sync sync) { return missing_for(sync, device).empty(); };
  if (!technique.syncs.empty() && std::none_of(technique.syncs.begin(), technique.syncs.end(), is_there))
    return missing_for(technique.syncs.back(), device);
  if (technique.needs_layered && !device.layered) return "layered rendering from vertex shaders";
  if (technique.needs_ordered > device.ordered_attachments) {
    return fmt::format(
        "{} attachments that are read back in draw order "
        "(VK_EXT_rasterization_order_attachment_access)",
        technique.needs_ordered);
  }
  return "";
}

namespace render {
namespace {

std::string name_of(Sync sync) {
  const auto ways = sync_ways();
  return std::find_if(ways.begin(), ways.end(), [&](const NamedSync& way) { return way.sync == sync; })->name;
}

std::string names_of(const std::vector<Sync>& syncs) {
  std::string names;
  for (const Sync sync : syncs) names.append(names.empty() ? "" : ", ").append(name_of(sync));
  return names;
}

// Returns why a way of synchronisation is not available, or an empty text if it is.
std::string obstacle(Sync sync, const TechniqueInfo& technique, const RenderOptions& options,
                     const DeviceInfo& device) {
  const std::string missing = missing_for(sync, device);
  if (!missing.empty()) return fmt::format("{}, which {} does not support", missing, device.name);
  // With a memory budget, the number of attachments follows from the budget, and k from that number.
  if (sync != Sync::ordered || technique.keeps_tail) return "";
  if (ordered_attachments_for(options.k) <= device.ordered_attachments) return "";
  return fmt::format("{} attachments for k = {}, and {} has {}", ordered_attachments_for(options.k),
                     options.k, device.name, device.ordered_attachments);
}

}  // namespace

// Makes the list from registry.h.
const std::vector<TechniqueEntry>& technique_entries() {
#define PELLUCID_ENTRY(technique) technique(),
  static const std::vector<TechniqueEntry> kEntries{PELLUCID_TECHNIQUES(PELLUCID_ENTRY)};
#undef PELLUCID_ENTRY
  return kEntries;
}

const TechniqueEntry& find_technique(const RenderOptions& options, const DeviceInfo& device) {
  std::string names;
  for (const TechniqueEntry& entry : technique_entries()) {
    names.append(names.empty() ? "" : ", ").append(entry.info.name);
    if (entry.info.name != options.technique) continue;
    const std::string missing = missing_for(entry.info, device);
    if (missing.empty()) return entry;
    throw Error(ErrorKind::bad_argument, fmt::format("technique {} needs {}, which {} does not support",
                                                     options.technique, missing, device.name));
  }
  throw Error(ErrorKind::bad_argument,
              fmt::format("there is no technique '{}'; there are {}", options.technique, names));
}

void check_options(const Camera& camera, const RenderOptions& options, const DeviceInfo& device,
                   std::uint32_t objects) {
  if (camera.width == 0 || camera.height == 0 || camera.width > device.max_side ||
      camera.height > device.max_side) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("{} draws images of 1 to {} pixels a side, not {}x{}", device.name,
                            device.max_side, camera.width, camera.height));
  }
  if (options.samples != 1 && options.samples != 4)
    throw Error(ErrorKind::bad_argument, "samples of a pixel: 1 or 4");
  if (options.k < 1 || options.k > 64) throw Error(ErrorKind::bad_argument, "k is not in 1..64");
  check_effect(options.effect, objects);
}

void check_technique(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device) {
  if (options.peeling.cull && !technique.uses(OptionGroup::culling)) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("technique {} does not peel, so nothing is drawn twice that could be culled",
                            technique.name));
  }
  if (options.peeling.cull && !device.conditional) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("culling needs conditional rendering, which {} does not support", device.name));
  }
  if (technique.keeps_tail) check_importance(options.budget.importance);
  if (!technique.blends_only && !technique.keeps_tail) return;
  if (!blends(options.effect)) {
    throw Error(
        ErrorKind::bad_argument,
        fmt::format("technique {} blends what it does not keep: it draws the effects transparency and "
                    "wireframe only",
                    technique.name));
  }
  if (technique.blends_only && options.keep_fragments) {
    throw Error(
        ErrorKind::bad_argument,
        fmt::format("technique {} blends while it draws: it has no fragments to keep", technique.name));
  }
}

Sync choose_sync(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device) {
  const std::vector<Sync>& syncs = technique.syncs;
  if (syncs.empty()) return Sync::automatic;
  Sync wanted = options.k_buffer.sync;
  if (wanted == Sync::automatic) {
    const auto open = std::find_if(syncs.begin(), syncs.end(), [&](Sync sync) {
      return obstacle(sync, technique, options, device).empty();
    });
    wanted = open != syncs.end() ? *open : syncs.back();
  }
  if (std::find(syncs.begin(), syncs.end(), wanted) == syncs.end()) {
    throw Error(ErrorKind::bad_argument, fmt::format("{} synchronisation: technique {} has only {}",
                                                     name_of(wanted), technique.name, names_of(syncs)));
  }
  const std::string reason = obstacle(wanted, technique, options, device);
  if (!reason.empty())
    throw Error(ErrorKind::bad_argument, fmt::format("{} synchronisation needs {}", name_of(wanted), reason));
  return wanted;
}

}  // namespace render
}  // namespace pellucid
