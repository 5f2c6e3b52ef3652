// Implements pellucid/overdraw_subject.h: turns a model file into posed triangles, and their orders into
// order sets of primitives.
#include "pellucid/overdraw_subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace pellucid {
namespace {

// Returns the parts that are ordered. Translucent parts are left out, because they hide nothing and need
// transparency orders.
std::vector<std::size_t> opaque_parts(const Model& model, const PosableModel& posable,
                                      std::vector<std::string>& notes) {
  std::vector<std::size_t> parts;
  for (std::size_t i = 0; i < posable.parts().size(); ++i) {
    const Primitive& primitive = model.primitives[posable.parts()[i].primitive];
    if (is_known_translucent(model, primitive)) {
      notes.push_back(primitive.name + ": left out: it is BLEND, which needs transparency orders");
    } else {
      parts.push_back(i);
    }
  }
  return parts;
}

bool draws_both_sides(const Model& model, const ModelPart& part, SidesChoice choice) {
  if (choice != SidesChoice::automatic) return choice == SidesChoice::both;
  return is_gltf(model) && part.double_sided;
}

void add_parts(const Model& model, const PosableModel& posable, const SubjectOptions& options,
               PosedSubject& posed) {
  OverdrawSubject& subject = posed.subject;
  subject.parts.clear();
  bool any_both = false;
  for (const std::size_t i : opaque_parts(model, posable, posed.notes)) {
    const ModelPart& part = posable.parts()[i];
    const std::size_t end =
        i + 1 < posable.parts().size() ? posable.parts()[i + 1].first_triangle : posable.triangles().size();
    if (end == part.first_triangle) continue;
    const auto begin = static_cast<std::uint32_t>(subject.triangles.size());
    posed.parts.push_back({part.primitive, begin, static_cast<std::uint32_t>(end - part.first_triangle)});
    if (!options.whole || subject.parts.empty()) subject.parts.push_back(begin);
    subject.triangles.insert(subject.triangles.end(), posable.triangles().begin() + part.first_triangle,
                             posable.triangles().begin() + static_cast<std::ptrdiff_t>(end));
    const bool both = draws_both_sides(model, part, options.sides);
    subject.double_sided.resize(subject.triangles.size(), both ? 1 : 0);
    any_both = any_both || both;
  }
  if (!any_both) subject.double_sided.clear();
  if (subject.triangles.empty()) {
    throw Error(ErrorKind::nothing_to_do, model.path + ": there are no opaque triangles to order");
  }
}

// Returns the clips with the wanted names or numbers, and all clips if none is wanted.
std::vector<std::uint32_t> choose_clips(const Model& model, const PosableModel& posable,
                                        const std::vector<std::string>& wanted) {
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t clip = 0; clip < posable.clips().size(); ++clip) {
    const AnimationClip& known = posable.clips()[clip];
    const bool named = std::any_of(wanted.begin(), wanted.end(), [&](const std::string& text) {
      return text == known.name || text == std::to_string(known.animation);
    });
    if (wanted.empty() || named) chosen.push_back(clip);
  }
  for (const std::string& text : wanted) {
    const bool found = std::any_of(chosen.begin(), chosen.end(), [&](std::uint32_t clip) {
      const AnimationClip& known = posable.clips()[clip];
      return text == known.name || text == std::to_string(known.animation);
    });
    if (found) continue;
    std::string names;
    for (const AnimationClip& clip : posable.clips()) names += (names.empty() ? "" : ", ") + clip.name;
    throw Error(ErrorKind::bad_argument,
                fmt::format("{}: there is no animation '{}' that moves something drawn{}", model.path, text,
                            names.empty() ? "" : "; there are: " + names));
  }
  return chosen;
}

// The part of an order of the subject that draws one primitive.
struct PrimitiveOrder {
  NodeSequence nodes;
  std::uint32_t rank = 0;  // position of the primitive among those of the order
};

class OrderSplitter {
 public:
  OrderSplitter(const PosedSubject& posed, const OverdrawSets& sets, const OverdrawOptions& options)
      : posed_(posed), sets_(sets) {
    const OverdrawSubject rest{
        posed.subject.triangles, posed.subject.parts, posed.subject.double_sided, {posed.rest}};
    Mesh mesh;
    mesh.positions = posed.rest;
    mesh.triangles = posed.subject.triangles;
    sphere_ = bounding_sphere(mesh);
    rest_orders_ = posed.clips.empty() ? sets.sets.front().cell_orders
                                       : cheapest_orders(rest, sets.sets.front(), options);
  }

  OrderedPrimitive primitive(std::size_t part) const {
    OrderedPrimitive ordered;
    ordered.primitive = posed_.parts[part].primitive;
    OrderSet& set = ordered.orders;
    set.purpose = OrderPurpose::overdraw;
    set.partition = {PartitionKind::viewpoints, sets_.view_level, 0};
    set.sphere = sphere_;
    set.valid_from = 1;
    set.facing = Facing::single;
    for (const OverdrawOrders& of_set : sets_.sets) {
      for (std::uint32_t order = 0; order < of_set.orders.size(); ++order) {
        PrimitiveOrder own = split(triangle_order(of_set, order), part);
        set.orders.push_back(std::move(own.nodes));
        set.model_ranks.push_back(own.rank);
      }
    }
    add_base(part, set);
    set.cell_orders = rest_orders_;
    set.animations = tables();
    return ordered;
  }

 private:
  [[nodiscard]] bool holds(std::size_t part, std::uint32_t triangle) const {
    const SubjectPart& p = posed_.parts[part];
    return triangle >= p.first_triangle && triangle - p.first_triangle < p.triangle_count;
  }

  [[nodiscard]] PrimitiveOrder split(const std::vector<std::uint32_t>& sequence, std::size_t part) const {
    PrimitiveOrder own;
    std::vector<std::uint8_t> met(posed_.parts.size(), 0);
    for (std::size_t i = 0; i < sequence.size();) {
      std::size_t p = 0;
      while (!holds(p, sequence[i])) ++p;
      if (p == part) {
        for (std::size_t k = 0; k < posed_.parts[p].triangle_count; ++k)
          own.nodes.push_back(node_of(sequence[i + k] - posed_.parts[p].first_triangle, false));
      } else if (own.nodes.empty()) {
        ++own.rank;
      }
      i += posed_.parts[p].triangle_count;
    }
    return own;
  }

  // Adds the base order and the patches. With several sets, each has its own patches, so no patches are
  // stored.
  void add_base(std::size_t part, OrderSet& set) const {
    const OverdrawOrders& first = sets_.sets.front();
    for (const std::uint32_t triangle : first.sequence) {
      if (holds(part, triangle)) set.base_sequence.push_back(triangle - posed_.parts[part].first_triangle);
    }
    if (sets_.sets.size() > 1) return;
    set.patch_offsets.push_back(0);
    for (std::size_t patch = 0; patch < first.patch_parts.size(); ++patch) {
      if (!holds(part, first.sequence[first.patch_offsets[patch]])) continue;
      set.patch_offsets.push_back(set.patch_offsets.back() + first.patch_offsets[patch + 1] -
                                  first.patch_offsets[patch]);
    }
  }

  [[nodiscard]] std::vector<KeyFrameTable> tables() const {
    std::vector<KeyFrameTable> tables;
    std::vector<std::uint32_t> first_order;
    std::uint32_t orders = 0;
    for (const OverdrawOrders& set : sets_.sets) {
      first_order.push_back(orders);
      orders += static_cast<std::uint32_t>(set.orders.size());
    }
    const std::size_t cells = 10 * (std::size_t{1} << (2 * sets_.view_level)) + 2;
    for (std::size_t frame = 0; frame < posed_.frames.size() && !posed_.clips.empty(); ++frame) {
      const PosedFrame& at = posed_.frames[frame];
      if (frame == 0 || at.clip != posed_.frames[frame - 1].clip) {
        tables.emplace_back();
        tables.back().animation = posed_.clips[at.clip].animation;
      }
      const OverdrawOrders& set = sets_.sets[sets_.set_of[frame]];
      const std::size_t row = sets_.frame_in_set[frame] * cells;
      tables.back().times.push_back(at.time);
      tables.back().spheres.push_back(set.spheres[sets_.frame_in_set[frame]]);
      for (std::size_t cell = 0; cell < cells; ++cell)
        tables.back().cell_orders.push_back(first_order[sets_.set_of[frame]] + set.cell_orders[row + cell]);
    }
    return tables;
  }

  const PosedSubject& posed_;
  const OverdrawSets& sets_;
  BoundingSphere sphere_;
  std::vector<std::uint32_t> rest_orders_;
};

}  // namespace

PosedSubject make_subject(const Model& model, const SubjectOptions& options) {
  const PosableModel posable(model, options.subdivisions);
  PosedSubject posed;
  add_parts(model, posable, options, posed);
  posed.rest = posable.rest_pose();
  for (const std::uint32_t clip : choose_clips(model, posable, options.animations)) {
    const AnimationClip& known = posable.clips()[clip];
    const auto number = static_cast<std::uint32_t>(posed.clips.size());
    posed.clips.push_back(known);
    const std::vector<double> times =
        options.keyframe_rate ? times_at_rate(known, *options.keyframe_rate) : known.key_times;
    for (const double time : times) {
      posed.frames.push_back({number, time});
      posed.subject.frames.emplace_back();
      posable.pose(clip, time, posed.subject.frames.back());
    }
  }
  if (posed.frames.empty()) {
    posed.frames.push_back({0, 0});
    posed.subject.frames.push_back(posed.rest);
  }
  return posed;
}

PosesBetween poses_between(const Model& model, const PosedSubject& posed, const SubjectOptions& options) {
  const PosableModel posable(model, options.subdivisions);
  PosesBetween between;
  between.subject = {posed.subject.triangles, posed.subject.parts, posed.subject.double_sided, {}};
  std::map<std::uint32_t, std::uint32_t> clip_of;
  for (std::uint32_t clip = 0; clip < posable.clips().size(); ++clip)
    clip_of[posable.clips()[clip].animation] = clip;
  for (std::uint32_t frame = 0; frame + 1 < posed.frames.size(); ++frame) {
    const PosedFrame& here = posed.frames[frame];
    if (posed.frames[frame + 1].clip != here.clip) continue;
    between.nearest.push_back(frame);
    between.subject.frames.emplace_back();
    posable.pose(clip_of[posed.clips[here.clip].animation], 0.5 * (here.time + posed.frames[frame + 1].time),
                 between.subject.frames.back());
  }
  return between;
}

std::vector<OrderedPrimitive> ordered_primitives(const PosedSubject& posed, const OverdrawSets& sets,
                                                 const OverdrawOptions& options) {
  const OrderSplitter splitter(posed, sets, options);
  std::vector<OrderedPrimitive> ordered;
  for (std::size_t part = 0; part < posed.parts.size(); ++part) {
    // A primitive that is drawn several times has the orders of its first instance.
    const bool known = std::any_of(ordered.begin(), ordered.end(), [&](const OrderedPrimitive& entry) {
      return entry.primitive == posed.parts[part].primitive;
    });
    if (!known) ordered.push_back(splitter.primitive(part));
  }
  return ordered;
}

}  // namespace pellucid
