// What `pellucid order` came to: see order_outcome.h.
#include "order_outcome.h"

#include <fmt/format.h>

#include <filesystem>

#include "session.h"

namespace pellucid::cli {
namespace {

bool is_svg(const std::string& path) {
  return std::filesystem::path(path).extension() == ".svg";
}

bool meets(const Reached& reached, const OrderOptions& target) {
  if (target.min_psnr) return reached.psnr < 0 || reached.psnr >= *target.min_psnr;
  return reached.ipr <= target.max_error;
}

std::string shortfall(const Reached& reached, const OrderOptions& target) {
  if (target.min_psnr) {
    return fmt::format("PSNR {:.2f} dB with {} buffers, asked for {:g} dB", reached.psnr, reached.buffers,
                       *target.min_psnr);
  }
  return fmt::format("wrong pixels {} with {} buffers, asked for {}", format_percent(reached.ipr),
                     reached.buffers, format_percent(target.max_error));
}

}  // namespace

void check_frontier_path(const std::string& path) {
  if (!is_svg(path) && std::filesystem::path(path).extension() != ".json") {
    throw Error(ErrorKind::bad_argument, path + ": a frontier is written as .json or .svg");
  }
  check_writable(path);
}

void write_frontier(const FrontierReport& report, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    write_file_atomically(path, is_svg(path) ? frontier_svg(report) : to_json(report));
  }
}

Reached reached_by(const PrimitiveOrderReport& report) {
  Reached reached{report.name, report.statistics.measured_error, report.statistics.measured_psnr,
                  report.buffers.size()};
  if (reached.ipr < 0 && report.error) reached.ipr = report.error->ipr_mean;
  if (reached.psnr < 0 && report.error) reached.psnr = report.error->psnr_mean;
  return reached;
}

Reached reached_by(const PrimitiveFrontier& primitive) {
  const FrontierPoint& point = primitive.frontier.points[primitive.frontier.chosen - 1];
  return {primitive.name, point.ipr, point.psnr, point.buffers};
}

void check_quality(const std::vector<Reached>& all, const OrderOptions& target, const std::string& input,
                   const std::string& written) {
  for (const Reached& reached : all) {
    if (meets(reached, target)) continue;
    throw Error(ErrorKind::quality_missed,
                fmt::format("{}: {}: {} (more --max-buffers may help); {} was written all the same", input,
                            reached.name, shortfall(reached, target), written));
  }
}

}  // namespace pellucid::cli
