// Makes the viewer that lays two images of a scene over each other, and the heat maps of the scene. In: a
// compared scene (pellucid/compare_report.h). Out: HTML. compare_viewer.js finds the image of a menu entry by
// its key (data-picture), and the scale of a heat map in its figure.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "report/compare_parts.h"
#include "report/heat_maps.h"
#include "report/html_page.h"

namespace pellucid {
namespace {

constexpr int kScaleSteps = 40;
// The largest amplification makes a step of 1/255 visible.
constexpr int kMostGain = 64;
constexpr int kFirstGain = 4;

// An image, and the techniques that drew it.
struct SharedImage {
  const ReportImage* drawn = nullptr;
  const ReportImage* difference = nullptr;
  std::vector<const ComparedTechnique*> techniques;
};

std::vector<SharedImage> shared_images(const ComparedScene& scene) {
  std::vector<SharedImage> all;
  for (const ComparedTechnique& technique : scene.techniques) {
    if (!technique.drawn() || technique.images.empty()) continue;
    const ReportImage& drawn = technique.images.front();
    auto same = std::find_if(all.begin(), all.end(),
                             [&](const SharedImage& other) { return other.drawn->png == drawn.png; });
    if (same == all.end()) {
      all.push_back({&drawn, technique.images.size() > 1 ? &technique.images[1] : nullptr, {}});
      same = all.end() - 1;
    }
    same->techniques.push_back(&technique);
  }
  return all;
}

std::string names_of(const std::vector<const ComparedTechnique*>& techniques) {
  std::string names;
  for (const ComparedTechnique* technique : techniques)
    names += (names.empty() ? "" : ", ") + technique->name;
  return names;
}

// ---------------------------------------------------------------------------------------------- the viewer

std::string image_key(std::size_t number) {
  return fmt::format("p{}", number);
}
std::string map_key(std::size_t number) {
  return fmt::format("m{}", number);
}
std::string key_attribute(const std::string& key) {
  return "data-picture=\"" + key + "\"";
}

std::string words_of(const ComparedTechnique& technique) {
  const std::string time = format_fixed(technique.stats.milliseconds, 1) + " ms";
  if (technique.equals_exact()) return time + ", no difference";
  return technique.error ? fmt::format("{}, {} dB", time, format_fixed(technique.error->psnr, 1)) : time;
}

// The entries of both menus. At first, the exact image is chosen on the left, and the image that differs most
// on the right.
class Menu {
 public:
  explicit Menu(const ComparedScene& scene) : scene_(scene) {
    groups_ = option(image_key(0), "exact", "by " + scene.reference);
    add_images();
    add_maps();
  }

  [[nodiscard]] std::string html(const char* side, const std::string& chosen) const {
    std::string text = groups_;
    const std::string value = "<option value=\"" + chosen + "\"";
    text.insert(text.find(value) + value.size(), " selected=\"selected\"");
    return fmt::format("<label>{0} <select class=\"{0}\">{1}</select></label>", side, text);
  }

  [[nodiscard]] const std::string& most_different() const { return most_different_; }

 private:
  static std::string option(const std::string& key, const std::string& name, const std::string& words) {
    return fmt::format("<option value=\"{}\" data-words=\"{}\">{}</option>", key, escape_html(words),
                       escape_html(name));
  }

  static std::string group(const char* label, const std::string& options) {
    return options.empty() ? "" : fmt::format("<optgroup label=\"{}\">{}</optgroup>", label, options);
  }

  void add_images() {
    std::string differing;
    std::string equal;
    double worst = INFINITY;
    const std::vector<SharedImage> images = shared_images(scene_);
    for (std::size_t p = 0; p < images.size(); ++p) {
      for (const ComparedTechnique* technique : images[p].techniques) {
        differing += option(image_key(p + 1), technique->name, words_of(*technique));
        if (technique->error && technique->error->psnr >= worst) continue;
        worst = technique->error ? technique->error->psnr : worst;
        most_different_ = image_key(p + 1);
      }
    }
    for (const ComparedTechnique& technique : scene_.techniques) {
      if (technique.drawn() && technique.images.empty())
        equal += option(image_key(0), technique.name, words_of(technique));
    }
    groups_ += group("differ from the exact image", differing) + group("equal to it", equal);
  }

  void add_maps() {
    std::string maps;
    std::size_t number = 0;
    const auto add = [&](const std::string& name, const ReportMap& map) {
      maps += option(map_key(number++), name, map.words);
    };
    for (const ReportMap& map : scene_.maps) add(map.name, map);
    for (const ComparedTechnique& technique : scene_.techniques)
      for (const ReportMap& map : technique.maps) add(technique.name + ": " + map.name, map);
    groups_ += group("heat maps", maps);
    if (most_different_.empty()) most_different_ = number > 0 ? map_key(0) : image_key(0);
  }

  const ComparedScene& scene_;
  std::string groups_;
  std::string most_different_;
};

std::string mode_choice(const std::string& id) {
  std::string text = "<fieldset class=\"modes\" aria-label=\"how both images are shown\">";
  for (const char* mode : {"swipe", "flip", "difference"}) {
    text += fmt::format("<label><input type=\"radio\" name=\"{0}-mode\" value=\"{1}\"{2}/>{1}</label>", id,
                        mode, mode == std::string("swipe") ? " checked=\"checked\"" : "");
  }
  return text + "</fieldset>";
}

std::string gain_choice() {
  std::string text = "<label>amplified <select class=\"gain\">";
  for (int gain = 1; gain <= kMostGain; gain *= 2) {
    text += fmt::format("<option value=\"{0}\"{1}>{0}\u00d7</option>", gain,
                        gain == kFirstGain ? " selected=\"selected\"" : "");
  }
  return text + "</select></label>";
}

// Returns the viewer, which is hidden until the script has drawn its images.
std::string scripted_viewer(const ComparedScene& scene, const std::string& id) {
  const Menu menu(scene);
  std::string text = "<div class=\"viewer\" hidden=\"hidden\"><div class=\"controls\">";
  text += menu.html("left", image_key(0)) +
          "<button type=\"button\" class=\"swap\" title=\"exchange both\">\u21c4</button>" +
          menu.html("right", menu.most_different());
  text += mode_choice(id) + gain_choice();
  text +=
      "<span class=\"zooms\"><button type=\"button\" value=\"out\" title=\"zoom out\">\u2212</button>"
      "<output></output><button type=\"button\" value=\"in\" title=\"zoom in\">+</button> "
      "<button type=\"button\" value=\"fit\">fit</button></span></div>";
  text += fmt::format(
      "<div class=\"stage\" tabindex=\"0\" style=\"aspect-ratio:{}/{}\" role=\"group\" aria-label=\"both "
      "images\"><canvas></canvas><div class=\"divider\" role=\"slider\" tabindex=\"0\" "
      "aria-label=\"where the right image begins, percent\" aria-valuemin=\"0\" aria-valuemax=\"100\" "
      "aria-valuenow=\"50\"></div><span class=\"tag left\"></span><span class=\"tag right\"></span></div>",
      scene.width, scene.height);
  return text +
         "<p class=\"readout\" role=\"status\"></p><div class=\"legends\"></div><p class=\"note\">Drag the "
         "divider, or move "
         "it "
         "with the arrow keys. Flip: hold the image, or the space bar, to see the right one in the place "
         "of "
         "the left one. Zoom with the buttons, a double click, two fingers, or the wheel after a click into "
         "the image; then drag to move both.</p></div>\n";
}

// ------------------------------------------------------------------------------------------ without a script

std::string plain_viewer(const ComparedScene& scene, const std::string& id) {
  Choices choices(id, "views");
  choices.add("exact", figure(scene.image.caption, scene.image.png, key_attribute(image_key(0))));
  for (const SharedImage& image : shared_images(scene)) {
    const std::string names = names_of(image.techniques);
    std::string figures = figure(names, image.drawn->png, key_attribute(image_key(choices.size())));
    if (image.difference != nullptr) figures += figure(image.difference->caption, image.difference->png);
    choices.add(names, figures);
  }
  if (choices.size() < 2) return choices.html();
  std::string text = choices.html();
  // The note is put into the element that the script hides.
  return text.insert(text.rfind("</div>"),
                     "<p class=\"note last\">Beside every image its difference from the exact one: white for "
                     "none, dark red for 64 steps of 255 or more.</p>");
}

std::string equal_names(const ComparedScene& scene) {
  std::vector<const ComparedTechnique*> equal;
  for (const ComparedTechnique& technique : scene.techniques)
    if (technique.drawn() && technique.images.empty()) equal.push_back(&technique);
  if (equal.empty()) return {};
  return "<p class=\"note\">No pixel differs by more than 1/255 from the exact picture: " +
         escape_html(names_of(equal)) + ".</p>";
}

// ------------------------------------------------------------------------------------------------ heat maps

std::string ramp_text() {
  std::string text;
  for (std::uint32_t step = 1; step <= kHeatSteps; ++step) {
    const Rgb color = heat_color(step);
    text += fmt::format("{}{},{},{}", text.empty() ? "" : " ", color[0], color[1], color[2]);
  }
  return text;
}

// Returns 1, 2 or 5 times a power of ten, so that there are at most five steps up to `most`.
double mark_step(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most / 5)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power * 5 >= most * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

// Returns the numbers below the colours, each where its colour is. Counts have integer steps.
std::string scale_numbers(double most) {
  if (!(most > 0)) return {};
  const bool is_count = most == std::floor(most);
  const double step = is_count ? std::max(1.0, mark_step(most)) : mark_step(most);
  std::string numbers;
  const auto add = [&](double value) {
    numbers += fmt::format("<span style=\"left:{:.1f}%\">{:.4g}</span>", 100 * value / most, value);
  };
  // The number before the last one must leave space for it.
  for (double value = step; value < most - step / 2; value += step) add(value);
  add(most);
  return numbers;
}

// Returns the scale of a heat map: white for zero, then the colours.
std::string heat_scale(const ReportMap& map) {
  std::string colors;
  for (int i = 0; i < kScaleSteps; ++i) {
    const Rgb color = heat_between((i + 0.5) / kScaleSteps);
    colors += fmt::format("<rect x=\"{}\" width=\"1.1\" height=\"1\" fill=\"#{:02x}{:02x}{:02x}\"/>", i,
                          color[0], color[1], color[2]);
  }
  return fmt::format(
      "<div class=\"legend\" data-most=\"{}\" data-unit=\"{}\" data-ramp=\"{}\"><span "
      "class=\"none\"><i></i>0</span><div class=\"scale\"><svg viewBox=\"0 0 {} 1\" "
      "preserveAspectRatio=\"none\" aria-hidden=\"true\">{}</svg><div class=\"marks\">{}</div></div></div>",
      map.most, escape_html(map.unit), ramp_text(), kScaleSteps, colors, scale_numbers(map.most));
}

}  // namespace

void Choices::add(const std::string& name, const std::string& content) {
  choices_ += fmt::format(
      "<input type=\"radio\" name=\"{0}\" id=\"{0}-{1}\"{2}/><label for=\"{0}-{1}\">{3}</label><div "
      "class=\"{4}\">{5}</div>\n",
      id_, count_, count_ == 0 ? " checked=\"checked\"" : "", escape_html(name), kind_, content);
  ++count_;
}

std::string image_viewer(const ComparedScene& scene, std::size_t number) {
  if (scene.image.png.empty()) return {};
  const std::string id = fmt::format("pictures{}", number);
  return "<div class=\"row\"><h3>Images</h3>" + scripted_viewer(scene, id) + plain_viewer(scene, id) +
         equal_names(scene) + "</div>";
}

std::string heat_map_section(const ComparedScene& scene) {
  std::string figures;
  std::size_t number = 0;
  const auto add = [&](const std::string& name, const ReportMap& map) {
    figures += figure(name + map.words, map.png, key_attribute(map_key(number++)), heat_scale(map)) + "\n";
  };
  for (const ReportMap& map : scene.maps) add("", map);
  for (const ComparedTechnique& technique : scene.techniques)
    for (const ReportMap& map : technique.maps) add(technique.name + ": ", map);
  if (figures.empty()) return {};
  return "<div class=\"row\"><h3>Heat maps</h3><div class=\"heats\">" + figures + "</div></div>";
}

}  // namespace pellucid
