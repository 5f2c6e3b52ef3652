// Draws overdraw over the animation, as in figure 8 of Han and Sander 2017 but for each key frame. In: an
// overdraw report (pellucid/overdraw_report.h). Out: SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellucid/overdraw_report.h"
#include "pellucid/report.h"
#include "report/charts.h"

namespace pellucid {
namespace {

constexpr double kChartWidth = 960;
constexpr double kChartLeft = 60;
constexpr double kChartRight = 800;  // names of the curves are to the right of it
constexpr double kChartTop = 60;
constexpr double kChartBottom = 300;
constexpr double kChartHeight = 334;
constexpr double kBarLeft = 150;  // names of the bars are to the left of it
constexpr double kBarPitch = 30;
constexpr double kBarHeight = 18;
constexpr int kMostAxisSteps = 5;      // steps of an axis
constexpr double kLeastExcess = 0.01;  // least excess at the end of an axis
constexpr std::size_t kMostBins = 300;
constexpr std::size_t kRowNameLength = 15;  // characters of a method's name
constexpr double kCharacter = 7.2;          // mean width at 12 pixels
constexpr double kClipRoom = 84;            // pixels for the name of a clip, even where the clip is narrower
constexpr double kSeparatorGap = 6;         // clips closer than this have separators only beside their names

// The key frames begin .. end - 1 of one clip. They are a whole clip (a segment of the axis) or a part of it
// (a point of a curve).
struct FrameRange {
  std::uint32_t clip = 0;
  std::size_t begin = 0, end = 0;

  [[nodiscard]] std::size_t size() const { return end - begin; }
};

std::vector<FrameRange> clip_ranges(const OverdrawReport& report, std::size_t frames) {
  std::vector<FrameRange> ranges;
  for (std::size_t f = 0; f < frames; ++f) {
    const std::uint32_t before = ranges.empty() ? 0 : ranges.back().clip;
    const std::uint32_t clip = f < report.frames.size() ? report.frames[f].clip : before;
    if (ranges.empty() || clip != before) ranges.push_back({clip, f, f});
    ranges.back().end = f + 1;
  }
  return ranges;
}

// Returns the points of a clip: at most kMostBins over all clips, but at least one per clip. A point belongs
// to one clip only.
std::vector<FrameRange> bins_of(const FrameRange& clip, std::size_t frames) {
  const std::size_t share = frames <= kMostBins ? clip.size() : clip.size() * kMostBins / frames;
  const std::size_t count = std::max<std::size_t>(1, share);
  std::vector<FrameRange> bins;
  for (std::size_t i = 0; i < count; ++i)
    bins.push_back(
        {clip.clip, clip.begin + clip.size() * i / count, clip.begin + clip.size() * (i + 1) / count});
  return bins;
}

bool is_seen(double overdraw) {
  return std::isfinite(overdraw) && overdraw > 0;
}

// Returns the mean over the frames in which anything was visible, or 0 if there is none.
double mean_of(const std::vector<double>& by_frame, const FrameRange& bin) {
  double sum = 0;
  std::size_t seen = 0;
  for (std::size_t f = bin.begin; f < std::min(bin.end, by_frame.size()); ++f) {
    if (!is_seen(by_frame[f])) continue;
    sum += by_frame[f];
    ++seen;
  }
  return seen == 0 ? 0 : sum / static_cast<double>(seen);
}

// An axis of overdraw, which begins at 1 and has steps of 1, 2 or 5 times a power of ten.
class Axis {
 public:
  Axis(double most, double at_one, double at_end) : at_one_(at_one), at_end_(at_end) {
    const double excess = std::max(most - 1, kLeastExcess);
    const double power = std::pow(10.0, std::floor(std::log10(excess)) - 1);
    for (const double factor : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
      step_ = factor * power;
      if (excess <= kMostAxisSteps * step_ * (1 + 1e-9)) break;
    }
    steps_ = static_cast<int>(std::ceil(excess / step_ - 1e-9));
    digits_ = std::max(1, static_cast<int>(-std::floor(std::log10(step_) + 1e-9)));
  }

  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] double tick(int i) const { return 1 + step_ * i; }
  [[nodiscard]] std::string label(int i) const { return format_fixed(tick(i), digits_); }
  [[nodiscard]] double at(double overdraw) const {
    return at_one_ + (at_end_ - at_one_) * (std::max(overdraw, 1.0) - 1) / (step_ * steps_);
  }

 private:
  double at_one_, at_end_;
  double step_ = 1;
  int steps_ = 1, digits_ = 1;
};

// Curves over key frames.
class OverdrawCurves {
 public:
  OverdrawCurves(const OverdrawReport& report, std::size_t frames)
      : report_(report),
        frames_(frames),
        clips_(clip_ranges(report, frames)),
        means_(means()),
        axis_(most(), kChartBottom, kChartTop) {}

  [[nodiscard]] std::string svg() const { return titles() + grid() + clip_names() + curves(); }

 private:
  // Indexed by row, clip and bin.
  using Means = std::vector<std::vector<std::vector<double>>>;

  [[nodiscard]] Means means() const {
    Means all;
    for (const OverdrawRow& row : report_.rows) {
      auto& of_row = all.emplace_back();
      for (const FrameRange& clip : clips_) {
        auto& of_clip = of_row.emplace_back();
        for (const FrameRange& bin : bins_of(clip, frames_))
          of_clip.push_back(mean_of(row.key_frames.by_frame, bin));
      }
    }
    return all;
  }

  [[nodiscard]] double most() const {
    double most = 1;
    for (const auto& row : means_) {
      for (const auto& clip : row) {
        for (const double mean : clip) most = std::max(most, mean);
      }
    }
    return most;
  }

  // Returns the x coordinate where a frame begins. Frame f extends from x(f) to x(f + 1).
  [[nodiscard]] double x(double frame) const {
    return kChartLeft + (kChartRight - kChartLeft) * frame / static_cast<double>(frames_);
  }

  [[nodiscard]] std::string titles() const {
    std::string words = fmt::format("{} key frames", format_count(frames_));
    if (clips_.size() > 1) words += fmt::format(" of {} clips, one after the other", clips_.size());
    if (frames_ > kMostBins) words += "; a point is the mean of neighbouring key frames";
    return text_svg(20, 24, "start", "", "Mean overdraw of every key frame (1 is the least)") +
           text_svg(20, 43, "start", "small soft", words);
  }

  [[nodiscard]] std::string grid() const {
    std::string svg;
    for (int i = 0; i <= axis_.steps(); ++i) {
      const double y = axis_.at(axis_.tick(i));
      svg += line_svg(kChartLeft, y, kChartRight, y, i == 0 ? "axis" : "grid");
      svg += text_svg(kChartLeft - 8, y + 4, "end", "small soft", axis_.label(i));
    }
    return svg;
  }

  struct ClipName {
    std::size_t frame = 0;  // the first frame of the clip
    std::string text;
    double left = 0, right = 0;
  };

  [[nodiscard]] std::string name_of(const FrameRange& clip) const {
    const bool is_named = clip.clip < report_.clips.size() && !report_.clips[clip.clip].name.empty();
    return is_named ? report_.clips[clip.clip].name : fmt::format("clip {}", clip.clip);
  }

  // Returns the names of clips in places that do not overlap. Long clips choose first.
  [[nodiscard]] std::vector<ClipName> placed_names() const {
    std::vector<FrameRange> longest_first = clips_;
    std::stable_sort(longest_first.begin(), longest_first.end(),
                     [](const FrameRange& a, const FrameRange& b) { return a.size() > b.size(); });
    std::vector<ClipName> names;
    for (const FrameRange& clip : longest_first) {
      const double left = x(static_cast<double>(clip.begin));
      const double room = std::max(x(static_cast<double>(clip.end)) - left, kClipRoom);
      const ClipName name{clip.begin, name_of(clip), left,
                          left + std::min(room, kCharacter * static_cast<double>(name_of(clip).size()) + 10)};
      if (std::none_of(names.begin(), names.end(), [&](const ClipName& other) {
            return name.left < other.right - 1e-6 && other.left < name.right - 1e-6;
          }))
        names.push_back(name);
    }
    std::stable_sort(names.begin(), names.end(),
                     [](const ClipName& a, const ClipName& b) { return a.frame < b.frame; });
    return names;
  }

  [[nodiscard]] std::string clip_names() const {
    std::string svg;
    const bool has_room = (kChartRight - kChartLeft) / static_cast<double>(clips_.size()) >= kSeparatorGap;
    for (const FrameRange& clip : clips_) {
      const double left = x(static_cast<double>(clip.begin));
      if (has_room && clip.begin > 0) svg += line_svg(left, kChartTop, left, kChartBottom, "clip");
    }
    for (const ClipName& name : placed_names()) {
      if (name.frame > 0)
        svg += line_svg(name.left, has_room ? kChartBottom : kChartTop, name.left, kChartBottom + 22, "clip");
      const auto characters = static_cast<std::size_t>((name.right - name.left - 10) / kCharacter + 1e-6);
      svg += fmt::format("<g><title>{}</title>\n{}</g>\n", escape_html(name.text),
                         text_svg(name.left + 4, kChartBottom + 19, "start", "small soft",
                                  abbreviated(name.text, std::max<std::size_t>(characters, 1))));
    }
    return svg;
  }

  // Returns the lines of a clip, which are interrupted where nothing was visible. A single point is drawn as
  // wide as its bin.
  [[nodiscard]] std::string polylines(const FrameRange& clip, const std::vector<double>& values) const {
    const std::vector<FrameRange> bins = bins_of(clip, frames_);
    std::string svg;
    for (std::size_t i = 0; i < bins.size();) {
      std::size_t end = i;
      while (end < bins.size() && values[end] > 0) ++end;
      std::string points;
      if (end == i + 1) {
        points = fmt::format("{:.1f},{:.1f} {:.1f},{:.1f}", x(static_cast<double>(bins[i].begin)),
                             axis_.at(values[i]), x(static_cast<double>(bins[i].end)), axis_.at(values[i]));
      }
      for (std::size_t k = i; end > i + 1 && k < end; ++k)
        points += fmt::format("{}{:.1f},{:.1f}", k == i ? "" : " ",
                              x(0.5 * static_cast<double>(bins[k].begin + bins[k].end)), axis_.at(values[k]));
      if (!points.empty()) svg += "<polyline points=\"" + points + "\"/>\n";
      i = end + 1;
    }
    return svg;
  }

  struct Label {
    std::size_t row = 0;
    double end = 0, y = 0;  // y of the end of the curve and of the name
  };

  // Returns labels for all rows that have a curve, beside the ends of the curves and not over each other.
  [[nodiscard]] std::vector<Label> placed_labels() const {
    std::vector<Label> labels;
    for (std::size_t row = 0; row < means_.size(); ++row) {
      double last = 0;
      for (const auto& clip : means_[row]) {
        for (const double mean : clip) last = mean > 0 ? mean : last;
      }
      if (last > 0) labels.push_back({row, axis_.at(last), 0});
    }
    std::vector<double> ends;
    ends.reserve(labels.size());
    for (const Label& label : labels) ends.push_back(label.end);
    const std::vector<double> heights = spread_labels(ends, kChartTop, kChartBottom);
    for (std::size_t i = 0; i < labels.size(); ++i) labels[i].y = heights[i];
    return labels;
  }

  // Draws the first row last, so that no other curve hides it.
  [[nodiscard]] std::string curves() const {
    const std::vector<Label> labels = placed_labels();
    std::string svg;
    for (std::size_t row = report_.rows.size(); row-- > 0;) {
      std::string content;
      for (std::size_t clip = 0; clip < clips_.size(); ++clip)
        content += polylines(clips_[clip], means_[row][clip]);
      const OverdrawRow& shown = report_.rows[row];
      for (const Label& label : labels) {
        if (label.row != row) continue;
        content += line_svg(kChartRight + 2, label.end, kChartRight + 14, label.y, "leader");
        content +=
            text_svg(kChartRight + 18, label.y + 4, "start", "",
                     abbreviated(shown.name, kRowNameLength) + " " + format_fixed(shown.key_frames.mean, 3));
      }
      svg += group_svg(row, row == 0, shown.name, content);
    }
    return svg;
  }

  const OverdrawReport& report_;
  std::size_t frames_;
  std::vector<FrameRange> clips_;
  Means means_;
  Axis axis_;
};

std::string bars_svg(const OverdrawReport& report, double bottom) {
  double most = 1;
  for (const OverdrawRow& row : report.rows)
    if (is_seen(row.key_frames.mean)) most = std::max(most, row.key_frames.mean);
  const Axis axis(most, kBarLeft, kChartRight);
  std::string svg = text_svg(20, 24, "start", "", "Mean overdraw (1 is the least)");
  for (int i = 0; i <= axis.steps(); ++i) {
    const double x = axis.at(axis.tick(i));
    svg += line_svg(x, kChartTop - 16, x, bottom, i == 0 ? "axis" : "grid");
    svg += text_svg(x, bottom + 18, "middle", "small soft", axis.label(i));
  }
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const OverdrawRow& row = report.rows[i];
    const double y = kChartTop - 10 + kBarPitch * static_cast<double>(i);
    const bool seen = is_seen(row.key_frames.mean);
    const double end = seen ? axis.at(row.key_frames.mean) : kBarLeft;
    svg += group_svg(i, i == 0, row.name,
                     fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
                                 kBarLeft, y, end - kBarLeft, kBarHeight) +
                         text_svg(kBarLeft - 10, y + 14, "end", "", abbreviated(row.name, kRowNameLength)) +
                         text_svg(end + 8, y + 14, "start", "",
                                  seen ? format_fixed(row.key_frames.mean, 3) : "nothing seen"));
  }
  return svg;
}

}  // namespace

std::size_t OverdrawReport::charted_frames() const {
  std::size_t longest = 0;
  for (const OverdrawRow& row : rows) longest = std::max(longest, row.key_frames.by_frame.size());
  return longest;
}

std::string overdraw_chart(const OverdrawReport& report, ChartPlace place) {
  const std::size_t frames = report.charted_frames();
  const double bars_bottom = kChartTop - 10 + kBarPitch * static_cast<double>(report.rows.size());
  double height = kChartHeight;
  std::string content;
  if (report.rows.empty()) {
    height = kChartTop;
    content = text_svg(20, 24, "start", "", "Nothing was measured.");
  } else if (frames > 1) {
    content = OverdrawCurves(report, frames).svg();
  } else {
    height = bars_bottom + 30;
    content = bars_svg(report, bars_bottom);
  }
  return fmt::format(
      "<svg{} viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" role=\"img\" "
      "aria-label=\"Mean overdraw, key frame by key frame\" class=\"chart\">\n{}\n<rect "
      "width=\"100%\" height=\"100%\" class=\"ground\"/>\n{}</svg>\n",
      place == ChartPlace::file ? " xmlns=\"http://www.w3.org/2000/svg\"" : "", kChartWidth, height,
      kChartWidth, height, kChartStyle, content);
}

}  // namespace pellucid
