// Techniques over all scenes of a report: see pellucid/compare_report.h.
#include <algorithm>
#include <cmath>

#include "pellucid/compare_report.h"

namespace pellucid {
namespace {

// Sums of what has a mean.
struct Gathered {
  TechniqueSummary summary;
  double log_ratios = 0;
  std::uint32_t ratios = 0;
};

Gathered& entry_of(std::vector<Gathered>& all, const ComparedTechnique& technique) {
  for (Gathered& one : all)
    if (one.summary.name == technique.name) return one;
  Gathered& added = all.emplace_back();
  added.summary.name = technique.name;
  added.summary.exact = technique.exact;
  return added;
}

void gather(const ComparedTechnique& technique, const ComparedScene& scene, Gathered& into) {
  TechniqueSummary& summary = into.summary;
  ++summary.scenes;
  if (!technique.drawn()) return;
  ++summary.drawn;
  summary.equal += technique.equals_exact() ? 1U : 0U;
  if (technique.error)
    summary.worst_psnr = std::min(summary.worst_psnr.value_or(INFINITY), technique.error->psnr);
  if (const std::optional<double> ratio = scene.time_ratio(technique); ratio && *ratio > 0) {
    into.log_ratios += std::log(*ratio);
    ++into.ratios;
  }
}

}  // namespace

std::vector<TechniqueSummary> summarize(const CompareReport& report) {
  std::vector<Gathered> all;
  for (const ComparedScene& scene : report.scenes)
    for (const ComparedTechnique& technique : scene.techniques)
      gather(technique, scene, entry_of(all, technique));
  std::vector<TechniqueSummary> summaries;
  for (Gathered& one : all) {
    if (one.ratios > 0) one.summary.time_ratio = std::exp(one.log_ratios / one.ratios);
    summaries.push_back(std::move(one.summary));
  }
  return summaries;
}

std::optional<double> ComparedScene::time_ratio(const ComparedTechnique& technique) const {
  const ComparedTechnique* fastest = fastest_exact();
  if (!technique.drawn() || fastest == nullptr || !(fastest->stats.milliseconds > 0)) return std::nullopt;
  return technique.stats.milliseconds / fastest->stats.milliseconds;
}

}  // namespace pellucid
