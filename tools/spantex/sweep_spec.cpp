// SPDX-License-Identifier: Apache-2.0
#include "sweep_spec.hpp"

#include <stdio.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>

#include <sim/file.hpp>
#include <sim/random.hpp>
#include <sim/sweep_subjects.hpp>
#include "options.hpp"
#include "sweep_json.hpp"

namespace spantex::tool {
namespace {

using kind = spec_node::kind;
constexpr uint64_t most_points = 1'000'000'000;

SPANTEX_WRAPS uint64_t hash_of(std::string_view text) {
  uint64_t h = 0xCBF29CE484222325u;  // FNV-1a
  for (const char c : text) h = (h ^ uint8_t(c)) * 0x100000001B3u;
  return h;
}

}  // namespace

// Reads the document's nodes into a specification; every refusal names a line.
class spec_builder {
 public:
  explicit spec_builder(std::string file) : file_(std::move(file)) {}

  sweep_spec build(const spec_node& root) {
    check_members(root, {"name", "about", "seed", "size", "base", "scenes", "measures", "parts"}, "a specification");
    spec_.folder_ = std::filesystem::path(file_).parent_path().string();
    for (const char* name : {"name", "about"})
      if (const spec_node* n = root.find(name)) text_of(*n, "'" + std::string(name) + "'");
    sweep_part common;
    common.scenes = {"tilted"};
    read_common(root, common);
    if (const spec_node* n = root.find("size")) spec_.size_ = size_of(*n);
    const spec_node* const parts = root.find("parts");
    if (parts == nullptr || parts->what != kind::list || parts->items.empty()) refuse(file_, parts != nullptr ? *parts : root, "'parts' must be a list of at least one part");
    for (const spec_node& n : parts->items) add_part(n, common);
    spec_.study_ = study_name();
    return std::move(spec_);
  }

 private:
  [[noreturn]] void stop(const spec_node& at, const std::string& reason) const { refuse(file_, at, reason); }

  void check_members(const spec_node& n, std::initializer_list<const char*> known, const std::string& what) const {
    if (n.what != kind::object) stop(n, what + " must be an object");
    for (const auto& [name, value] : n.members)
      if (std::none_of(known.begin(), known.end(), [&known_name = name](const char* k) { return known_name == k; })) {
        std::string list;
        for (const char* k : known) list += (list.empty() ? "" : ", ") + std::string(k);
        stop(value, "unknown '" + name + "' in " + what + " (known: " + list + ")");
      }
  }

  std::string text_of(const spec_node& n, const std::string& what) const {
    if (n.what != kind::text || n.text.empty()) stop(n, what + " must be a text");
    return n.text;
  }

  uint64_t count_of(const spec_node& n, const std::string& what, uint64_t most) const {
    if (n.what != kind::integer || n.integer < 1 || uint64_t(n.integer) > most) stop(n, what + " must be a whole number from 1 to " + std::to_string(most));
    return uint64_t(n.integer);
  }

  sim::screen_size size_of(const spec_node& n) const {
    try {
      const sim::screen_size size = parse_size(text_of(n, "'size'"));
      if (size.width_px < 16 || size.height_px < 16 || size.width_px > 1024 || size.height_px > 1024) stop(n, "'size': sides must be 16 to 1024");
      return size;
    } catch (const sim::input_error& e) {
      const std::string reason = e.what();
      if (reason.rfind(file_, 0) == 0) throw;
      stop(n, reason.substr(reason.find("size")));
    }
  }

  const sweep_axis& axis_of(const std::string& name, const spec_node& at) const {
    if (name == "weight_bits") stop(at, "'weight_bits': weights are the fraction of a snapped position: vary subtexel_bits");
    const sweep_axis* const axis = find_axis(name);
    if (axis != nullptr) return *axis;
    std::string list;
    for (const sweep_axis& a : sweep_axes()) list += (list.empty() ? "" : ", ") + std::string(a.name);
    stop(at, "unknown axis '" + name + "' (known: " + list + ")");
  }

  std::string value_of_axis(const sweep_axis& axis, const spec_node& n) const {
    std::string value;
    if (n.what == kind::integer) value = std::to_string(n.integer);
    else if (n.what == kind::text) value = n.text;
    else if (n.what == kind::truth) value = n.truth ? "yes" : "no";
    else stop(n, std::string(axis.name) + ": a value must be a whole number, a text or true or false");
    if (const auto reason = why_not(axis, value)) stop(n, *reason);
    if (axis.name == "map" && !sim::is_sweep_map(value)) check_picture(n, value);
    return value;
  }

  void check_not_scene(const sweep_axis& axis, const spec_node& n) const {
    if (axis.name == "scene") stop(n, "scenes are listed under 'scenes'");
  }

  void check_picture(const spec_node& n, const std::string& value) const {
    try {
      sim::load_image((std::filesystem::path(spec_.folder_) / value).string());
    } catch (const sim::input_error& e) {
      stop(n, std::string("map: ") + e.what());
    }
  }

  // A list of values, one value, or from, to and step.
  std::vector<std::string> values_of_axis(const sweep_axis& axis, const spec_node& n) const {
    std::vector<std::string> values;
    if (n.what == kind::object) {
      check_members(n, {"from", "to", "step"}, "a range");
      const spec_node *from = n.find("from"), *to = n.find("to"), *step = n.find("step");
      if (from == nullptr || to == nullptr) stop(n, std::string(axis.name) + ": a range needs 'from' and 'to'");
      const std::string low = value_of_axis(axis, *from), high = value_of_axis(axis, *to);
      if (from->what != kind::integer || to->what != kind::integer) stop(n, std::string(axis.name) + ": a range is of whole numbers");
      const auto by = int64_t(step == nullptr ? 1 : count_of(*step, "'step'", 1000));
      if (from->integer > to->integer) stop(n, std::string(axis.name) + ": from " + low + " to " + high + " holds nothing");
      for (int64_t k = from->integer; k <= to->integer; k += by) {
        spec_node one = n;
        one.what = kind::integer;
        one.integer = k;
        values.push_back(value_of_axis(axis, one));
      }
    } else if (n.what == kind::list) {
      for (const spec_node& item : n.items) {
        values.push_back(value_of_axis(axis, item));
        if (std::count(values.begin(), values.end(), values.back()) > 1) stop(item, std::string(axis.name) + ": '" + values.back() + "' twice");
      }
    } else {
      values.push_back(value_of_axis(axis, n));
    }
    if (values.empty()) stop(n, std::string(axis.name) + ": no values");
    return values;
  }

  // What a part takes from the whole where it does not say so itself.
  void read_common(const spec_node& n, sweep_part& part) const {
    if (const spec_node* base = n.find("base")) {
      if (base->what != kind::object) stop(*base, "'base' must be an object");
      for (const auto& [name, value] : base->members) {
        const sweep_axis& axis = axis_of(name, value);
        check_not_scene(axis, value);
        std::erase_if(part.base, [&](const axis_value& v) { return v.first == &axis; });
        part.base.emplace_back(&axis, value_of_axis(axis, value));
      }
    }
    if (const spec_node* scenes = n.find("scenes")) {
      if (scenes->what != kind::list) stop(*scenes, "'scenes' must be a list");
      part.scenes = values_of_axis(*find_axis("scene"), *scenes);
    }
    if (const spec_node* measures = n.find("measures")) part.measures = measures_of(*measures);
    if (const spec_node* seed = n.find("seed")) part.seed = count_of(*seed, "'seed'", uint64_t(1) << 62);
  }

  sim::measure_groups measures_of(const spec_node& n) const {
    if (n.what != kind::list || n.items.empty()) stop(n, "'measures' must be a list of at least one group");
    sim::measure_groups groups;
    groups.wanted.fill(false);
    for (const spec_node& item : n.items) {
      const std::string name = text_of(item, "a measure");
      const auto& names = sim::measure_group_names;
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end()) {
        std::string list;
        for (const auto& known : names) list += (list.empty() ? "" : ", ") + std::string(known);
        stop(item, "unknown measure '" + name + "' (known: " + list + ")");
      }
      bool& wanted = groups.wanted[size_t(found - names.begin())];
      if (wanted) stop(item, "measure '" + name + "' twice");
      wanted = true;
    }
    return groups;
  }

  void add_part(const spec_node& n, const sweep_part& common) {
    check_members(n, {"name", "about", "seed", "sample", "points", "base", "scenes", "measures", "axes"}, "a part");
    sweep_part part = common;
    const spec_node* const name = n.find("name");
    if (name == nullptr) stop(n, "a part needs a 'name'");
    part.name = text_of(*name, "'name'");
    if (std::any_of(part.name.begin(), part.name.end(), [](char c) { return uint8_t(c) < ' ' || c == ',' || c == '"'; })) stop(*name, "'name' holds a comma, quote or control character");
    if (const spec_node* about = n.find("about")) text_of(*about, "'about'");
    for (const sweep_part& other : spec_.parts_)
      if (other.name == part.name) stop(*name, "part '" + part.name + "' twice");
    read_common(n, part);
    const spec_node* const axes = n.find("axes");
    if (axes == nullptr || axes->what != kind::object || axes->members.empty()) stop(axes != nullptr ? *axes : n, "part '" + part.name + "' needs 'axes', an object of at least one axis");
    for (const auto& [axis_name, value] : axes->members) {
      const sweep_axis& axis = axis_of(axis_name, value);
      check_not_scene(axis, value);
      part.axes.push_back({&axis, values_of_axis(axis, value)});
    }
    sample(n, part);
    check_motion(n, part);
    spec_.points_ += part.points();
    if (part.points_a_scene > most_points || spec_.points_ > most_points) stop(n, "more than " + std::to_string(most_points) + " points");
    spec_.parts_.push_back(std::move(part));
  }

  void sample(const spec_node& n, sweep_part& part) const {
    const spec_node* const how = n.find("sample");
    const std::string name = how == nullptr ? "grid" : text_of(*how, "'sample'");
    const spec_node* const points = n.find("points");
    if (name != "grid" && name != "one-at-a-time" && name != "random") stop(*how, "unknown sample '" + name + "' (known: grid, one-at-a-time, random)");
    if (points != nullptr && name != "random") stop(*points, "'points' belongs to sample random");
    if (name == "grid") {
      part.sample = sweep_sample::grid;
      part.points_a_scene = 1;
      for (const swept_axis& a : part.axes) part.points_a_scene = std::min(part.points_a_scene * a.values.size(), most_points + 1);
    } else if (name == "one-at-a-time") {
      part.sample = sweep_sample::one_at_a_time;
      sim::sweep_point base;
      apply(part.base, base);
      for (size_t a = 0; a < part.axes.size(); ++a)
        for (size_t v = 0; v < part.axes[a].values.size(); ++v)
          if (part.axes[a].axis->get(base) != part.axes[a].values[v]) part.steps.emplace_back(a, v);
      part.points_a_scene = 1 + part.steps.size();
    } else {
      part.sample = sweep_sample::random;
      if (points == nullptr) stop(n, "sample random needs 'points'");
      part.points_a_scene = count_of(*points, "'points'", most_points);
    }
  }

  void check_motion(const spec_node& n, const sweep_part& part) const {
    const sweep_axis& motion = *find_axis("motion");
    std::vector<std::string> motions;
    for (const axis_value& v : part.base)
      if (v.first == &motion) motions.push_back(v.second);
    for (const swept_axis& a : part.axes)
      if (a.axis == &motion) motions.insert(motions.end(), a.values.begin(), a.values.end());
    for (const std::string& m : motions)
      for (const std::string& scene : part.scenes) {
        sim::sweep_point p;
        motion.set(p, m);
        if (!sim::moves(scene, p.subject.motion)) stop(n, "part '" + part.name + "': scene " + scene + " has no motion '" + m + "'");
      }
  }

  std::string study_name() const {
    std::string text = std::to_string(spec_.size_.width_px) + "x" + std::to_string(spec_.size_.height_px);
    for (const sweep_axis& a : sweep_axes()) text += ";" + std::string(a.name);
    for (const auto& c : sim::measure_columns) text += ";" + std::string(c.name);
    for (const sweep_part& p : spec_.parts_) {
      text += "\n" + p.name + ";" + std::to_string(int(p.sample)) + ";" + std::to_string(p.seed) + ";" + std::to_string(p.points_a_scene);
      for (const axis_value& v : p.base) text += ";" + std::string(v.first->name) + "=" + v.second;
      for (const std::string& scene : p.scenes) text += ";" + scene;
      for (const swept_axis& a : p.axes) {
        text += ";" + std::string(a.axis->name);
        for (const std::string& v : a.values) text += "," + v;
      }
      for (const bool wanted : p.measures.wanted) text += wanted ? "+" : "-";
    }
    char digits[17];
    snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash_of(text)));
    return digits;
  }

 public:
  // A profile before what differs from it.
  static void apply(std::vector<axis_value> values, sim::sweep_point& p) {
    std::stable_sort(values.begin(), values.end(), [](const axis_value& a, const axis_value& b) { return a.first < b.first; });
    for (const auto& [axis, value] : values) axis->set(p, value);
  }

 private:
  std::string file_;
  sweep_spec spec_;
};

sweep_spec sweep_spec::parse(const std::string& file, const std::string& text) { return spec_builder(file).build(parse_spec(file, text)); }

sweep_spec sweep_spec::load(const std::string& file) {
  const sim::bytes data = sim::read_file(file);
  return parse(file, std::string(data.begin(), data.end()));
}

numbered_point sweep_spec::at(uint64_t number) const {
  const sweep_part* part = parts_.data();
  while (number >= part->points()) number -= (part++)->points();
  const uint64_t step = number % part->points_a_scene;
  std::vector<axis_value> values = part->base;
  const auto take = [&](size_t axis, size_t value) {
    std::erase_if(values, [&](const axis_value& v) { return v.first == part->axes[axis].axis; });
    values.emplace_back(part->axes[axis].axis, part->axes[axis].values[value]);
  };
  switch (part->sample) {
    case sweep_sample::grid: {
      uint64_t rest = step;
      for (size_t a = part->axes.size(); a-- > 0; rest /= part->axes[a].values.size()) take(a, size_t(rest % part->axes[a].values.size()));
      break;
    }
    case sweep_sample::one_at_a_time:
      if (step > 0) take(part->steps[step - 1].first, part->steps[step - 1].second);
      break;
    case sweep_sample::random:
      for (size_t a = 0; a < part->axes.size(); ++a)
        take(a, sim::random_source(sim::mix(part->seed, step, a)).below(uint32_t(part->axes[a].values.size())));
      break;
  }
  numbered_point n{part, {}};
  n.point.subject.size = size_;
  n.point.subject.map_folder = folder_;
  spec_builder::apply(values, n.point);
  n.point.subject.scene = part->scenes[size_t(number / part->points_a_scene)];
  return n;
}

}  // namespace spantex::tool
