// Synchronisation: see synchronisation.h.
#include "render/capture/synchronisation.h"

#include <fmt/format.h>

#include <algorithm>

namespace pellucid::render {
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

// Why a way is not open; empty: it is.
std::string obstacle(Sync sync, const TechniqueInfo& technique, const RenderOptions& options,
                     const DeviceInfo& device) {
  const std::string missing = missing_for(sync, device);
  if (!missing.empty()) return fmt::format("{}, which {} has not", missing, device.name);
  // A budget says how many attachments there are, and these how many fragments.
  if (sync != Sync::ordered || technique.keeps_tail) return "";
  if (ordered_attachments_for(options.k) <= device.ordered_attachments) return "";
  return fmt::format("{} attachments for --k {}, and {} has {}", ordered_attachments_for(options.k),
                     options.k, device.name, device.ordered_attachments);
}

}  // namespace

Sync choose_sync(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device) {
  const std::vector<Sync>& syncs = technique.syncs;
  if (syncs.empty()) return Sync::automatic;
  Sync wanted = options.sync;
  if (wanted == Sync::automatic) {
    const auto open = std::find_if(syncs.begin(), syncs.end(), [&](Sync sync) {
      return obstacle(sync, technique, options, device).empty();
    });
    wanted = open != syncs.end() ? *open : syncs.back();
  }
  if (std::find(syncs.begin(), syncs.end(), wanted) == syncs.end()) {
    throw Error(ErrorKind::bad_argument, fmt::format("--sync {}: --technique {} has only {}", name_of(wanted),
                                                     technique.name, names_of(syncs)));
  }
  const std::string reason = obstacle(wanted, technique, options, device);
  if (!reason.empty())
    throw Error(ErrorKind::bad_argument, fmt::format("--sync {} needs {}", name_of(wanted), reason));
  return wanted;
}

}  // namespace pellucid::render
