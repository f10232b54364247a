// SPDX-License-Identifier: Apache-2.0
#include "sweep_axes.hpp"

#include <limits.h>
#include <stdlib.h>

#include <algorithm>
#include <array>

#include <sim/draw_host.hpp>
#include <sim/sweep_subjects.hpp>

namespace spantex::tool {
namespace {

using sim::named, sim::sweep_point;

constexpr std::array<named<overflow_policy>, 3> overflow_names{{{"coarser", overflow_policy::coarser}, {"clamp", overflow_policy::clamp}, {"split", overflow_policy::split}}};
constexpr std::array<named<level_scope>, 2> scope_names{{{"span", level_scope::span}, {"pixel", level_scope::pixel}}};
constexpr std::array<named<rounding>, 3> rounding_names{{{"floor", rounding::floor}, {"nearest", rounding::nearest}, {"even", rounding::even}}};
constexpr std::array<named<evaluation_order>, 7> order_names{
    {{"by-tolerance", evaluation_order::by_tolerance}, {"affine", evaluation_order::affine}, {"series1", evaluation_order::series1},
     {"series2", evaluation_order::series2}, {"series3", evaluation_order::series3}, {"series4", evaluation_order::series4}, {"divide", evaluation_order::divide}}};
constexpr std::array<named<sim::bank_map>, 2> bank_names{{{"parity", sim::bank_map::parity}, {"columns", sim::bank_map::columns}}};
constexpr std::array<named<sim::camera_motion>, 5> motion_names{
    {{"none", sim::camera_motion::none}, {"pan", sim::camera_motion::pan}, {"zoom", sim::camera_motion::zoom},
     {"approach", sim::camera_motion::approach}, {"turn", sim::camera_motion::turn}}};
constexpr std::array<named<bool>, 2> yes_no{{{"no", false}, {"yes", true}}};
constexpr std::array<named<colour_space>, 2> colour_names{{{"coded", colour_space::coded}, {"srgb", colour_space::srgb}}};
constexpr std::array<named<int>, 3> span_names{{{"4", 2}, {"8", 3}, {"16", 4}}};
constexpr std::array<named<int>, 3> side_names{{{"8", 8}, {"16", 16}, {"32", 32}}};
constexpr std::array<named<bool>, 2> half_names{{{"1", true}, {"2", false}}};  // single_half

// A member of a point as an axis: place() gives a reference to it.
template <const auto& Names, auto Place>
sweep_axis choice(std::string_view name) {
  sweep_axis a{name, "", 0, 0, {}, false, nullptr, nullptr};
  for (const auto& n : Names) a.names.push_back(n.name);
  a.get = [](const sweep_point& p) { return std::string(sim::name_of(Names, Place(const_cast<sweep_point&>(p)))); };
  a.set = [](sweep_point& p, const std::string& value) {
    for (const auto& n : Names)
      if (n.name == value) Place(p) = n.value;
  };
  return a;
}

template <auto Place>
sweep_axis whole(std::string_view name, std::string_view unit, int low, int high) {
  return {name, unit, low, high, {}, false, [](const sweep_point& p) { return std::to_string(Place(const_cast<sweep_point&>(p))); },
          [](sweep_point& p, const std::string& value) { Place(p) = atoi(value.c_str()); }};
}

template <auto Place>
sweep_axis text(std::string_view name, std::vector<std::string_view> names) {
  return {name, "", 0, 0, std::move(names), true, [](const sweep_point& p) { return Place(const_cast<sweep_point&>(p)); },
          [](sweep_point& p, const std::string& value) { Place(p) = value; }};
}

#define SPANTEX_OF(member) [](sim::sweep_point& p) -> auto& { return p.member; }

sweep_axis profile_axis() {
  sweep_axis a{"profile", "", 0, 0, {}, false, [](const sweep_point& p) { return p.profile; }, [](sweep_point& p, const std::string& value) {
                 p.profile = value;
                 for (const auto& n : sim::profile_names)
                   if (n.name == value) p.machine = {sim::profile_of(n.value, {})};
               }};
  for (const auto& n : sim::profile_names) a.names.push_back(n.name);
  return a;
}

sweep_axis scene_axis() {
  sweep_axis a = text<SPANTEX_OF(subject.scene)>("scene", {});
  a.is_text = false;
  for (const std::string& n : sim::sweep_scene_names()) a.names.push_back(n);
  return a;
}

void add_subject(std::vector<sweep_axis>& a) {
  a.push_back(scene_axis());
  a.push_back(text<SPANTEX_OF(subject.map)>("map", {}));
  a.push_back(whole<SPANTEX_OF(subject.map_side)>("map_side", "texels", 16, 2048));
  a.push_back(choice<sim::wrap_names, SPANTEX_OF(subject.wraps)>("wrap"));
  a.push_back(choice<sim::prefilter_names, SPANTEX_OF(subject.levels)>("prefilter"));
  a.push_back(choice<sim::format_names, SPANTEX_OF(subject.format)>("format"));
  a.push_back(choice<colour_names, SPANTEX_OF(subject.colours)>("colours"));
  a.push_back(whole<SPANTEX_OF(subject.pitch_degrees)>("pitch_degrees", "degrees", 1, 90));
  a.push_back(whole<SPANTEX_OF(subject.minification_16)>("minification_16", "1/16 log2 texels a pixel", -96, 128));
  a.push_back(whole<SPANTEX_OF(subject.turn_degrees)>("turn_degrees", "degrees", -180, 180));
  a.push_back(choice<motion_names, SPANTEX_OF(subject.motion)>("motion"));
  a.push_back(whole<SPANTEX_OF(subject.frames)>("frames", "", 2, 64));
}

void add_profile(std::vector<sweep_axis>& a) {
  a.push_back(choice<sim::filter_names, SPANTEX_OF(kind)>("filter"));
  a.push_back(choice<side_names, SPANTEX_OF(machine.value.fine_side)>("fine_side"));
  a.push_back(choice<overflow_names, SPANTEX_OF(machine.value.overflow)>("overflow"));
  a.push_back(choice<scope_names, SPANTEX_OF(machine.value.scope)>("scope"));
  a.push_back(choice<sim::level_names, SPANTEX_OF(machine.value.formula)>("formula"));
  a.push_back(whole<SPANTEX_OF(machine.value.level_bias)>("level_bias", "1/16 level", -128, 127));
  a.push_back(whole<SPANTEX_OF(machine.value.mip_bias)>("mip_bias", "1/16 level", -16, 0));
  a.push_back(whole<SPANTEX_OF(machine.value.coordinate_bits)>("coordinate_bits", "bits", 4, 16));
  a.push_back(whole<SPANTEX_OF(machine.value.offset_bits)>("offset_bits", "bits", 12, 31));
  a.push_back(whole<SPANTEX_OF(machine.value.reciprocal_bits)>("reciprocal_bits", "bits", 12, 30));
  a.push_back(whole<SPANTEX_OF(machine.value.tolerance_bits)>("tolerance_bits", "bits", 0, 16));
  a.push_back(whole<SPANTEX_OF(machine.value.subtexel_bits)>("subtexel_bits", "bits", 1, 8));
  a.push_back(whole<SPANTEX_OF(machine.value.level_bits)>("level_bits", "bits", 1, 8));
  a.push_back(whole<SPANTEX_OF(machine.value.blend_bits)>("blend_bits", "bits", 0, 16));
  a.push_back(whole<SPANTEX_OF(machine.value.max_samples)>("max_samples", "", 1, 16));
  a.push_back(whole<SPANTEX_OF(machine.value.sample_spacing)>("sample_spacing", "1/16 octave", 0, 16));
  a.push_back(whole<SPANTEX_OF(machine.value.sample_slack)>("sample_slack", "1/16", 0, 15));
  a.push_back(whole<SPANTEX_OF(machine.value.sample_bias)>("sample_bias", "1/16 level", -16, 0));
  a.push_back(whole<SPANTEX_OF(machine.value.area_side_log2)>("area_side_log2", "", 1, 4));
  a.push_back(choice<yes_no, SPANTEX_OF(machine.value.exact_set_up)>("exact_set_up"));
  a.push_back(choice<yes_no, SPANTEX_OF(machine.value.linear_light)>("linear_light"));
  a.push_back(choice<rounding_names, SPANTEX_OF(machine.value.position_rounding)>("position_rounding"));
  a.push_back(choice<rounding_names, SPANTEX_OF(machine.value.colour_rounding)>("colour_rounding"));
}

void add_machine(std::vector<sweep_axis>& a) {
  a.push_back(whole<SPANTEX_OF(machine.units.reciprocal_table_log2)>("reciprocal_table_log2", "", 3, 10));
  a.push_back(whole<SPANTEX_OF(machine.units.reciprocal_iterations)>("reciprocal_iterations", "", 0, 2));
  a.push_back(choice<order_names, SPANTEX_OF(machine.units.order)>("evaluation"));
  a.push_back(choice<span_names, SPANTEX_OF(machine.units.span_log2)>("span_side"));
  a.push_back(choice<bank_names, SPANTEX_OF(banks)>("banks"));
  a.push_back(choice<half_names, SPANTEX_OF(single_half)>("halves"));
  a.push_back(whole<SPANTEX_OF(table.port_words)>("port_words", "words", 1, 16));
  a.push_back(whole<SPANTEX_OF(table.cycles_per_transfer)>("cycles_per_transfer", "cycles", 1, 64));
  a.push_back(whole<SPANTEX_OF(table.burst_start_cycles)>("burst_start_cycles", "cycles", 0, 1024));
  a.push_back(whole<SPANTEX_OF(table.cycles_per_pixel)>("cycles_per_sample", "cycles", 1, 64));
  a.push_back(whole<SPANTEX_OF(table.coordinate_fill_cycles)>("coordinate_fill_cycles", "cycles", 0, 64));
}

#undef SPANTEX_OF

std::string listed(const std::vector<std::string_view>& names) {
  std::string text;
  for (const std::string_view n : names) text += (text.empty() ? "" : ", ") + std::string(n);
  return text;
}

}  // namespace

const std::vector<sweep_axis>& sweep_axes() {
  static const std::vector<sweep_axis> axes = [] {
    std::vector<sweep_axis> a{profile_axis()};
    add_profile(a);
    add_machine(a);
    add_subject(a);
    return a;
  }();
  return axes;
}

const sweep_axis* find_axis(std::string_view name) {
  for (const sweep_axis& a : sweep_axes())
    if (a.name == name) return &a;
  return nullptr;
}

std::optional<std::string> why_not(const sweep_axis& axis, const std::string& value) {
  const std::string what = std::string(axis.name) + ": ";
  if (axis.is_text) {
    const bool control = std::any_of(value.begin(), value.end(), [](char c) { return uint8_t(c) < ' '; });
    if (value.empty() || control || value.find_first_of(",\"|") != std::string::npos) return what + "'" + value + "' is empty or holds a comma, quote, bar or control character";
    return std::nullopt;
  }
  if (!axis.names.empty()) {
    if (std::find(axis.names.begin(), axis.names.end(), value) != axis.names.end()) return std::nullopt;
    return what + "unknown '" + value + "' (known: " + listed(axis.names) + ")";
  }
  const long number = strtol(value.c_str(), nullptr, 10);
  if (number != LONG_MIN && number != LONG_MAX && value != std::to_string(number)) return what + "'" + value + "' is not a whole number";
  if (number < axis.low || number > axis.high) return what + value + " is outside " + std::to_string(axis.low) + ".." + std::to_string(axis.high);
  return std::nullopt;
}

}  // namespace spantex::tool
