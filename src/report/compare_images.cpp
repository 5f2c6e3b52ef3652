// The pictures of a report of techniques as files: see pellucid/compare_report.h.
#include "report/compare_images.h"

#include <fmt/format.h>

#include <cctype>
#include <filesystem>

namespace pellucid {
namespace {

// What any file system and any shell takes.
std::string plain_name(const std::string& input) {
  std::string name = std::filesystem::path(input).stem().string();
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80U || (std::isalnum(byte) == 0 && c != '-' && c != '_' && c != '.')) c = '_';
  }
  return name;
}

}  // namespace

std::string image_path(const CompareReport& report, std::size_t scene, const std::string& what) {
  const std::string name = plain_name(report.scenes[scene].input);
  return report.scenes.size() == 1 ? fmt::format("images/{}-{}.png", name, what)
                                   : fmt::format("images/{}-{}-{}.png", scene + 1, name, what);
}

std::vector<ImageFile> image_files(const CompareReport& report) {
  std::vector<ImageFile> files;
  for (std::size_t s = 0; s < report.scenes.size(); ++s) {
    const ComparedScene& scene = report.scenes[s];
    const auto add = [&](const std::string& what, const std::vector<std::uint8_t>& png) {
      files.push_back({image_path(report, s, what), &png});
    };
    if (!scene.picture.png.empty()) add("exact", scene.picture.png);
    for (const ReportMap& map : scene.maps) add(map.name, map.png);
    for (const ComparedTechnique& technique : scene.techniques) {
      const std::string& name = technique.name;
      if (!technique.pictures.empty()) add(name, technique.pictures[0].png);
      if (technique.pictures.size() > 1) add(name + "-difference", technique.pictures[1].png);
      for (const ReportMap& map : technique.maps) add(name + "-" + map.name, map.png);
    }
  }
  return files;
}

}  // namespace pellucid
