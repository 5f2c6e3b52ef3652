// Animations: see gltf_animation.h. Format: glTF 2.0, section 3.11 and appendix C.
#include "asset/gltf_animation.h"

#include <cmath>
#include <tuple>

#include "asset/component.h"
#include "asset/gltf_deformation.h"

namespace pellucid {
namespace {

// How the values of a path lie in an accessor.
struct ValueForm {
  const char* type;
  std::uint32_t width;              // numbers per value
  std::uint32_t elements_of_value;  // of the accessor
};

std::optional<AnimatedPath> path_of(const std::string& name) {
  if (name == "translation") return AnimatedPath::translation;
  if (name == "rotation") return AnimatedPath::rotation;
  if (name == "scale") return AnimatedPath::scale;
  if (name == "weights") return AnimatedPath::weights;
  return std::nullopt;
}

ValueForm form_of(AnimatedPath path, const RigNode& node) {
  const auto targets = static_cast<std::uint32_t>(node.weights.size());
  if (path == AnimatedPath::weights) return {"SCALAR", targets, targets};
  if (path == AnimatedPath::rotation) return {"VEC4", 4, 1};
  return {"VEC3", 3, 1};
}

Interpolation interpolation_of(const Fields& sampler) {
  const std::string name = sampler.text_or("interpolation", "LINEAR");
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  sampler.fail("interpolation " + name.substr(0, 20) + " does not exist");
}

class AnimationReader {
 public:
  AnimationReader(const Fields& root, AccessorReader& accessors, Rig& rig)
      : root_(root), accessors_(accessors), rig_(rig) {}

  void read() {
    for (std::uint64_t i = 0; i < root_.size("animations"); ++i) {
      const Fields fields = root_.element("animations", i);
      RigAnimation animation;
      animation.name = short_name(fields.text_or("name", "animation " + std::to_string(i)));
      for (std::uint64_t c = 0; c < fields.size("channels"); ++c) read_channel(fields, c, animation);
      rig_.animations.push_back(std::move(animation));
    }
  }

 private:
  void read_channel(const Fields& animation, std::uint64_t index, RigAnimation& result) {
    const Fields channel = animation.element("channels", index);
    const Fields target = channel.object("target");
    const auto path = path_of(target.text("path"));
    const auto node = target.find_index("node");
    if (!path || !node) return;
    if (*node >= rig_.nodes.size()) target.fail("node " + std::to_string(*node) + " does not exist");
    const RigNode& moved = rig_.nodes[*node];
    if (*path == AnimatedPath::weights && moved.weights.empty()) return;
    if (*path != AnimatedPath::weights && moved.rest.matrix) {
      target.fail("node " + std::to_string(*node) + " has a matrix, which can not be animated");
    }
    const Fields sampler = animation.element("samplers", channel.index("sampler"));
    result.channels.push_back(
        {static_cast<std::uint32_t>(*node), *path, find_curve(sampler, form_of(*path, moved))});
  }

  // Samplers of all animations share accessors: each pair is read once.
  std::uint32_t find_curve(const Fields& sampler, const ValueForm& form) {
    const Interpolation interpolation = interpolation_of(sampler);
    const std::uint64_t input = sampler.index("input");
    const std::uint64_t output = sampler.index("output");
    const Key key{input, output, interpolation, form.width, form.elements_of_value};
    if (const auto known = curves_.find(key); known != curves_.end()) return known->second;
    AnimationCurve curve;
    curve.interpolation = interpolation;
    curve.width = form.width;
    curve.times = read_times(input);
    curve.values = read_values(sampler, output, form, curve);
    const auto index = static_cast<std::uint32_t>(rig_.curves.size());
    rig_.curves.push_back(std::move(curve));
    curves_.emplace(key, index);
    return index;
  }

  std::vector<float> read_times(std::uint64_t accessor) {
    const Fields fields = accessors_.accessor(accessor);
    if (fields.index("componentType") != single_float) fields.fail("times of key frames are not floats");
    std::vector<float> times = read_reals(accessor, "SCALAR", accessors_);
    if (times.empty()) fields.fail("an animation without key frames");
    for (std::size_t i = 0; i < times.size(); ++i) {
      const bool later = i == 0 ? times[i] >= 0 : times[i] > times[i - 1];
      if (!later || !std::isfinite(times[i])) {
        fields.fail("time " + std::to_string(i) + " is negative, not finite, or not later than that before");
      }
    }
    return times;
  }

  std::vector<float> read_values(const Fields& sampler, std::uint64_t accessor, const ValueForm& form,
                                 const AnimationCurve& curve) {
    const std::uint64_t values = curve.interpolation == Interpolation::cubic_spline ? 3 : 1;
    const std::uint64_t expected = values * curve.times.size() * form.elements_of_value;
    const std::uint64_t count = accessors_.count(accessor);
    if (count != expected) {
      sampler.fail("its output has " + std::to_string(count) + " elements; " +
                   std::to_string(curve.times.size()) + " key frames need " + std::to_string(expected));
    }
    std::vector<float> result = read_reals(accessor, form.type, accessors_);
    if (const auto at = find_non_finite(result); at >= 0) {
      accessors_.accessor(accessor).fail("number " + std::to_string(at) + " of it is not finite");
    }
    return result;
  }

  using Key = std::tuple<std::uint64_t, std::uint64_t, Interpolation, std::uint32_t, std::uint32_t>;

  const Fields& root_;
  AccessorReader& accessors_;
  Rig& rig_;
  std::map<Key, std::uint32_t> curves_;
};

}  // namespace

void read_animations(const Fields& root, AccessorReader& accessors, Rig& rig) {
  AnimationReader(root, accessors, rig).read();
}

}  // namespace pellucid
