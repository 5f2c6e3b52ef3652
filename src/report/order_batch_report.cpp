// What `pellucid order` did with many files, as JSON and one line each: see pellucid/report.h.
#include <fmt/format.h>

#include <algorithm>

#include "report/order_json.h"

namespace pellucid {

std::string to_json(const OrderBatchReport& report) {
  Json results = Json::array();
  for (const OrderReport& result : report.results) results.push_back(json_of(result));
  Json failures = Json::array();
  for (const OrderFailure& failure : report.failures) {
    failures.push_back({{"input", failure.input},
                        {"output", failure.output},
                        {"exit_code", failure.exit_code},
                        {"message", failure.message}});
  }
  Json skipped = Json::array();
  for (const auto& [input, output] : report.skipped)
    skipped.push_back({{"input", input}, {"output", output}});
  return dump({{"schema", kJsonSchema},
               {"version", library_version()},
               {"inputs", report.inputs},
               {"interrupted", report.interrupted},
               {"results", std::move(results)},
               {"failures", std::move(failures)},
               {"skipped", std::move(skipped)},
               {"seconds", {{"total", report.seconds_total}}},
               {"peak_rss_bytes", report.peak_rss_bytes}});
}

std::string to_line(const OrderReport& report) {
  std::uint64_t triangles = 0;
  std::size_t buffers = 0;
  double error = -1;
  for (const PrimitiveOrderReport& primitive : report.primitives) {
    triangles += primitive.triangles;
    buffers += primitive.buffers.size();
    error =
        std::max(error, primitive.error ? primitive.error->ipr_mean : primitive.statistics.measured_error);
  }
  return fmt::format("{}: {} triangles, {} buffer(s), {}, wrong pixels {}, {}\n", report.output,
                     format_count(triangles), buffers, format_bytes(report.disk_bytes),
                     error < 0 ? "-" : format_percent(error), format_seconds(report.seconds_total));
}

}  // namespace pellucid
