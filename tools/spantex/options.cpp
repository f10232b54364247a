// SPDX-License-Identifier: Apache-2.0
#include "options.hpp"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include <sim/model.hpp>
#include <sim/pack.hpp>

namespace spantex::tool {
namespace {

using sim::input_error;

bool all_digits(const std::string& s) {
  return !s.empty() && s.size() <= 9 && std::all_of(s.begin(), s.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// Determinant after bringing the coefficients to the picture's scale and each row to 1: 0 for a singular matrix, whatever its units.
double relative_determinant(const sim::matrix& m, sim::screen_size size) {
  double a[3][3];
  for (size_t r = 0; r < 3; ++r) {
    const double row[3] = {m[3 * r] * size.width_px, m[3 * r + 1] * size.height_px, m[3 * r + 2]};
    const double largest = std::max({fabs(row[0]), fabs(row[1]), fabs(row[2])});
    if (!(largest > 0)) return 0;
    for (size_t k = 0; k < 3; ++k) a[r][k] = row[k] / largest;
  }
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
         a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

// False if points are in front of the viewer but none of them has coordinates that the engine takes.
bool any_in_range(const sim::matrix& m, sim::screen_size size) {
  constexpr double limit = 32768;
  bool any_in_front = false;
  for (int j = 0; j < size.height_px; ++j)
    for (int i = 0; i < size.width_px; ++i) {
      const sim::ideal_position p = sim::position(m, i + 0.5, j + 0.5);
      if (!(p.w > 0)) continue;
      if (fabs(p.u) < limit && fabs(p.v) < limit) return true;
      any_in_front = true;
    }
  return !any_in_front;
}

sim::camera_options camera_of(const subject_options& o) {
  sim::camera_options c;
  if (!o.camera.empty() && (!o.eye.empty() || !o.target.empty()))
    throw input_error("--camera and --eye with --target: give one or the other");
  if (!o.camera.empty()) {
    const std::vector<double> n = parse_numbers(o.camera, 3, "--camera");
    c.yaw_degrees = n[0];
    c.pitch_degrees = n[1];
    c.distance_radii = n[2];
    if (n[2] < 0) throw input_error("--camera: distance is negative");
  }
  if (o.eye.empty() != o.target.empty()) throw input_error("--eye and --target: give both or none");
  if (!o.eye.empty()) {
    const std::vector<double> e = parse_numbers(o.eye, 3, "--eye"), t = parse_numbers(o.target, 3, "--target");
    c.eye = {e[0], e[1], e[2]};
    c.target = {t[0], t[1], t[2]};
  }
  if (!(o.fov_degrees >= 10 && o.fov_degrees <= 150)) throw input_error("--fov: outside 10..150 degrees");
  c.vertical_degrees = o.fov_degrees;
  return c;
}

}  // namespace

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& w : words) text += (text.empty() ? "" : ", ") + w;
  return text;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) parts.emplace_back();
    else parts.back() += c;
  }
  return parts;
}

void check_outputs(const std::vector<named_output>& outputs, const std::vector<std::string>& inputs) {
  std::set<std::string> read;
  for (const std::string& path : inputs)
    if (!path.empty()) read.insert(sim::place_of(path));
  std::map<std::string, std::string> writer;
  for (const auto& [option, path] : outputs) {
    const std::string place = path.empty() ? "" : sim::place_of(path);
    if (place.empty()) continue;
    if (read.contains(place)) throw input_error(option + ": would replace " + path + ", which is read");
    const auto [other, is_new] = writer.try_emplace(place, option);
    if (!is_new) throw input_error(other->second + " and " + option + ": both would write " + path);
  }
}

void refuse_repeats(const char* option, std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  if (twice != names.end()) throw input_error(std::string(option) + ": '" + *twice + "' is named twice");
}

filter judged_filter(const std::string& name) {
  const filter kind = value_of(sim::filter_names, name, "filter");
  if (kind == filter::contour) throw input_error("--filters: contour is a coverage, the reference has none");
  return kind;
}

std::vector<filter> judged_filters() {
  std::vector<filter> kinds = values_of(sim::filter_names, {"all"}, "filter");
  std::erase(kinds, filter::contour);
  return kinds;
}

void check_range(const char* option, int value, int low, int high) {
  if (value < low || value > high) throw input_error(option + (": " + std::to_string(value)) + " is outside " + std::to_string(low) + ".." + std::to_string(high));
}

double parse_number(const std::string& text, const std::string& what) {
  char* end = nullptr;
  errno = 0;
  const double value = strtod(text.c_str(), &end);
  const bool whole = !text.empty() && end == text.c_str() + text.size() && !isspace(static_cast<unsigned char>(text[0]));
  if (!whole) throw input_error(what + ": '" + text + "' is not a number");
  if (!std::isfinite(value)) throw input_error(what + ": '" + text + "' is not a finite number");
  return value;
}

std::vector<double> parse_numbers(const std::string& text, size_t count, const std::string& what) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != count)
    throw input_error(what + ": expected " + std::to_string(count) + " numbers separated by commas, got " + std::to_string(parts.size()));
  std::vector<double> numbers;
  for (const std::string& p : parts) numbers.push_back(parse_number(p, what));
  return numbers;
}

sim::screen_size parse_size(const std::string& text) {
  const std::vector<std::string> parts = split(text, 'x');
  const auto side = [&](size_t k) { return atoi(parts[k].c_str()); };
  const bool good = parts.size() == 2 && all_digits(parts[0]) && all_digits(parts[1]);
  if (!good || side(0) < 1 || side(1) < 1 || side(0) > max_screen_px || side(1) > max_screen_px)
    throw input_error("--size: '" + text + "' is not WxH with both in 1.." + std::to_string(max_screen_px));
  return {side(0), side(1)};
}

rgba8 parse_colour(const std::string& text, const char* option) {
  const bool good = text.size() == 6 && text.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
  if (!good) throw input_error(std::string(option) + ": '" + text + "' is not RRGGBB");
  const unsigned long value = strtoul(text.c_str(), nullptr, 16);
  return {uint8_t(value >> 16), uint8_t(value >> 8), uint8_t(value), 255};
}

sim::matrix parse_matrix(const std::string& text, sim::screen_size size) {
  if (const auto known = sim::named_plane(text)) return *known;
  const std::vector<double> numbers = parse_numbers(text, 9, "--matrix");
  sim::matrix m;
  std::copy(numbers.begin(), numbers.end(), m.begin());
  double largest = 0;
  for (const double x : m) largest = std::max(largest, fabs(x));
  if (!(largest > 0)) throw input_error("--matrix: singular: every coefficient is zero");
  for (double& x : m) x /= largest;  // only ratios matter
  constexpr double smallest_determinant = 1e-12;
  if (fabs(relative_determinant(m, size)) < smallest_determinant)
    throw input_error("--matrix: singular: its determinant is zero relative to its coefficients");
  if (!any_in_range(m, size)) throw input_error("--matrix: overflow: texture coordinates exceed 32768 texels at every pixel");
  return m;
}

std::string unless_given(const std::string& of_profile_default) { return " (not given: the profile's, " + of_profile_default + " in profile default)"; }

void drawing_options::add_to(CLI::App& app, bool with_engine) {
  app.add_option("--filter", filter, list_of(sim::filter_names))->capture_default_str();
  app.add_option("--space", space, "screen: spans of the screen; object: RD16, a grid on each polygon, spread over the pixels")->capture_default_str();
  app.add_option("--profile", profile, list_of(sim::profile_names))->capture_default_str();
  app.add_option("--level", level, "level of detail: jacobian (longer column), major or minor (KT88's axes)" + unless_given(std::string(sim::name_of(sim::level_names, profiles::standard.formula))));
  app.add_option("--samples", samples, "filter aniso: at most so many samples along a footprint, 1..16" + unless_given(std::to_string(profiles::standard.max_samples)));
  app.add_option("--spacing", spacing, "filter aniso: samples as far apart as the footprint is wide, beyond two widths 2^(this/16) times that, 0..16: quality against cost" + unless_given(std::to_string(profiles::standard.sample_spacing)));
  app.add_option("--slack", slack, "filter aniso: samples fewer by so many sixteenths of one, 0..15: quality against cost" + unless_given(std::to_string(profiles::standard.sample_slack)));
  app.add_option("--bias", bias, "filter aniso: sixteenths added to the level of the footprint's minor axis, -16..0: sharpness against aliasing" + unless_given(std::to_string(profiles::standard.sample_bias)));
  wrap_given_ = app.add_option("--wrap", wrap, list_of(sim::wrap_names))->capture_default_str();
  prefilter_given_ = app.add_option("--prefilter", prefilter, list_of(sim::prefilter_names))->capture_default_str();
  format_given_ = app.add_option("--format", format, "texels in global texture memory: " + list_of(sim::format_names))->capture_default_str();
  app.add_option("--background", background, "RRGGBB where nothing is drawn")->capture_default_str();
  app.add_option("--alpha", alpha, "opaque, cut-out[:T] (alpha below T, 128, is left out), blended, premultiplied")->capture_default_str();
  app.add_flag("--srgb", srgb, "colours of maps are sRGB codes: levels and filters in linear light (a pack's levels are as it was compiled)");
  app.add_option("--outline", outline, "filter contour: width of its line in pixels, to 1/16; 0 fills the inside");
  app.add_option("--threshold", threshold, "filter contour: the field (alpha) where the contour runs, 0..255");
  app.add_option("--field-scale", field_scale, "filter contour: field units per texel across the contour, 1/16..255");
  if (!with_engine) return;
  app.add_option("--engine", engine, list_of(sim::engine_names))->capture_default_str();
  app.add_option("--kernel", kernel, "who draws, the bytes are the same; pixels: profiles default and exact with any numbers of aniso, the others but scalar: default with any --samples; " + list_of(sim::kernel_names))->capture_default_str();
  app.add_option("--threads", threads, "threads, each with its own engine, 1.." + std::to_string(most_threads))->capture_default_str();
  app.add_option("--repeat", repeat, "draw so often, 1.." + std::to_string(most_repeats) + "; times are medians")->capture_default_str();
  app.add_option("--cull", culled, "polygons left out by how their corners run on the screen: " + list_of(sim::cull_names) + " (clockwise: the backs of closed models)")->capture_default_str();
  app.add_option("--skip", skip, "one that is off unless asked for: other-half (words of a section that the other half holds, for its time)");
  app.add_option("--no-skip", no_skip, "the picture is the same: work that the engine skips and now does, NAME[,NAME...] of " + list_of(sim::skip_names) + ", levels, unchanged, occluded, all");
}

void check_changes(const sim::profile_changes& c, filter kind) {
  if ((c.max_samples || c.sample_spacing || c.sample_slack || c.sample_bias) && kind != filter::aniso) throw input_error("--samples, --spacing, --slack, --bias: only filter aniso has them");
  if (c.max_samples) check_range("--samples", *c.max_samples, 1, max_footprint_samples);
  if (c.sample_spacing) check_range("--spacing", *c.sample_spacing, 0, 16);
  if (c.sample_slack) check_range("--slack", *c.sample_slack, 0, 15);
  if (c.sample_bias) check_range("--bias", *c.sample_bias, -16, 0);
  const bool has_level = uses_levels(kind) && !uses_footprint(kind) && !uses_area(kind);
  if (c.level && !has_level) throw input_error("--level: filter " + std::string(sim::name_of(sim::filter_names, kind)) + " has no level or its own");
}

shading parse_alpha(const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  shading how;
  how.alpha = value_of(sim::alpha_names, parts[0], "alpha mode");
  if (parts.size() == 1) return how;
  if (how.alpha != alpha_mode::cut_out || parts.size() > 2) throw input_error("--alpha: '" + text + "': only cut-out takes a threshold, cut-out:T");
  if (!all_digits(parts[1]) || atoi(parts[1].c_str()) > 255) throw input_error("--alpha: '" + text + "': threshold outside 0..255");
  how.threshold = uint8_t(atoi(parts[1].c_str()));
  return how;
}

skip_choice parse_no_skip(const std::string& text) {
  skip_choice kept;
  if (text.empty()) return kept;
  for (const std::string& name : split(text, ',')) {
    if (name == "all") kept = {0, false, false, false};
    else if (name == "levels") kept.levels = false;
    else if (name == "unchanged") kept.unchanged = false;
    else if (name == "occluded") kept.occluded = false;
    else if (const auto* const found = std::find_if(sim::skip_names.begin(), sim::skip_names.end(), [&](const auto& n) { return n.name == name; }); found != sim::skip_names.end())
      kept.drawing &= ~only(found->value);
    else throw input_error("--no-skip: unknown skip '" + name + "' (known: " + list_of(sim::skip_names) + ", levels, unchanged, occluded, all)");
  }
  return kept;
}

skip_set parse_skip(const std::string& text) {
  if (!text.empty() && text != "other-half") throw input_error("--skip: unknown skip '" + text + "' (known: other-half)");
  return text.empty() ? 0 : only(spantex::skip::other_half);
}

sim::output_file wanted_output(const std::string& path) { return path.empty() ? sim::output_file() : sim::output_file(path); }

void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw input_error(path + ": cannot make folder: " + error.message());
}

int parse_parts(const std::string& text, const char* option, double low, double high, int parts) {
  const double value = parse_number(text, option);
  char range[64];
  snprintf(range, sizeof range, "%g..%g", low, high);
  if (!(value >= low && value <= high)) throw input_error(std::string(option) + ": '" + text + "' is outside " + range);
  return int(lround(value * parts));
}

void drawing_options::parse_contour(sim::draw_options& o) const {
  const std::pair<const char*, bool> given[] = {{"--outline", outline.has_value()}, {"--threshold", threshold.has_value()}, {"--field-scale", field_scale.has_value()}};
  for (const auto& [option, is_given] : given)
    if (is_given && o.kind != filter::contour) throw input_error(std::string(option) + ": only filter contour has one");
  if (outline) o.outline = uint8_t(parse_parts(*outline, "--outline", 0, 255 / 16.0, 16));
  if (threshold) o.threshold = uint16_t(parse_parts(*threshold, "--threshold", 0, 255, 256));
  if (field_scale) o.field_scale = uint16_t(parse_parts(*field_scale, "--field-scale", 1 / 16.0, 255, 256));
}

void refuse_reference(const sim::draw_options& o, const std::string& option) {
  if (o.how.alpha != alpha_mode::opaque || o.kind == filter::contour)
    throw input_error(option + ": the reference is opaque: not with --alpha or filter contour");
  if (o.culled != sim::cull::none) throw input_error(option + ": the reference draws every polygon: not with --cull");
}

sim::draw_options drawing_options::resolve() const {
  check_range("--threads", threads, 1, most_threads);
  check_range("--repeat", repeat, 1, most_repeats);
  wrap_mode();
  level_filter();
  texels();
  sim::draw_options o;
  o.profile = value_of(sim::profile_names, profile, "profile");
  o.engine = value_of(sim::engine_names, engine, "engine");
  o.kind = value_of(sim::filter_names, filter, "filter");
  o.space = value_of(sim::space_names, space, "space");
  if (level) o.changes.level = value_of(sim::level_names, *level, "level of detail");
  o.changes.max_samples = samples;
  o.changes.sample_spacing = spacing;
  o.changes.sample_slack = slack;
  o.changes.sample_bias = bias;
  check_changes(o.changes, o.kind);
  if (o.space == sim::sampling_space::object) {
    if (o.engine != sim::engine_choice::direct) throw input_error("--space object: runs on engine direct only");
    if (threads != 1) throw input_error("--space object: runs on one thread only");
    if (uses_footprint(o.kind) || uses_area(o.kind)) throw input_error("--space object: filter " + filter + " has a footprint of its own; take one without");
    if (o.changes.any()) throw input_error("--space object: has one level a polygon: not with --level");
  }
  o.background = parse_colour(background, "--background");
  o.how = parse_alpha(alpha);
  o.culled = value_of(sim::cull_names, culled, "winding");
  o.skips = parse_no_skip(no_skip).drawing | parse_skip(skip);
  parse_contour(o);
  const bool plain = o.how.alpha == alpha_mode::opaque && !srgb && o.kind != filter::contour;
  if (o.space == sim::sampling_space::object && !plain)
    throw input_error("--space object: draws opaque, coded colours: not with --alpha, --srgb or filter contour");
  o.kernel = value_of(sim::kernel_names, kernel, "kernel");
  if (o.kernel != kernels::choice::scalar && kernels::kernel_of(o.kernel) == nullptr) throw input_error("--kernel " + kernel + ": this machine has not what it takes");
  o.threads = threads;
  o.repeat = repeat;
  o.single_half = single_half;
  return o;
}

sim::texture_map load_map(const std::string& path, const drawing_options& d) {
  sim::bytes data = sim::read_file(path);
  if (!sim::is_pack(data.data(), data.size()) && !path.ends_with(".stx"))
    return {sim::decode_image(data.data(), data.size(), path), d.level_filter(), d.wrap_mode(), d.wrap_mode(), d.texels(), d.colours(), d.most_levels(), d.making()};
  if (d.wrap_given()) throw input_error("--wrap: " + path + " has its own wrap modes; give them when it is compiled");
  if (d.prefilter_given()) throw input_error("--prefilter: " + path + " has its levels; give it when it is compiled");
  if (d.format_given()) throw input_error("--format: " + path + " has its format; give it when it is compiled");
  sim::texture_map map(std::move(data), path);
  if (d.srgb) map.set_colours(colour_space::srgb);
  return map;
}

void subject_options::add_to(CLI::App& app, bool with_matrix) {
  const std::string scenes = "a scene (" + joined(sim::scene_names()) + "), a model file of any format that assimp reads, or a Quake III level (.bsp, .pk3)";
  CLI::Option* const what = app.add_option("subject", subject, scenes)->type_name("MODEL|SCENE");
  app.add_option("--texture", texture, "map of a plane, a picture or a texture pack, instead of a built-in one");
  app.add_option("--size", size, "picture size, WxH")->capture_default_str();
  app.add_option("--camera", camera, "yaw,pitch,distance: degrees, degrees, radii of the model (0: all of it in the picture)");
  app.add_option("--eye", eye, "x,y,z of the camera, with --target");
  app.add_option("--target", target, "x,y,z that the camera looks at, with --eye");
  fov_given_ = app.add_option("--fov", fov_degrees, "angle of view of the picture's height, 10..150 degrees")->capture_default_str();
  app.add_option("--map", map, "which level of a .pk3 archive");
  app.add_option("--order", order, "polygons as in the file, nearest first, or nearest first and all depths before any texture: file, nearest, depths; levels are drawn nearest first");
  if (with_matrix) app.add_option("--matrix", matrix, "instead of a scene: a plane, A,B,C,D,E,F,G,H,I")->excludes(what);
  else what->required();
}

void subject_options::check_consistent() const {
  const bool plane = !matrix.empty() || sim::named_plane(subject), scene = plane || sim::is_scene_name(subject);
  const std::string what = matrix.empty() ? "'" + subject + "'" : "a plane from --matrix";
  const std::pair<const char*, bool> views[] = {{"--camera", !camera.empty()}, {"--eye", !eye.empty()}, {"--target", !target.empty()},
                                                {"--fov", fov_given_ != nullptr && fov_given_->count() > 0}};
  for (const auto& [option, given] : views)
    if (scene && given) throw input_error(std::string(option) + ": " + what + " has its own view; only models take a camera");
  if (!map.empty() && !sim::is_level(subject)) throw input_error("--map: " + what + " is no archive of levels");
  if (!order.empty() && order != "file" && order != "nearest" && order != "depths") throw input_error("--order: '" + order + "' is none of file, nearest, depths");
  if (!order.empty() && plane) throw input_error("--order: " + what + " is one surface");
  if (!texture.empty() && !plane) throw input_error("--texture: " + what + " has its own maps; only a plane takes a texture");
}

subject_options::loaded::loaded(const subject_options& o, const drawing_options& d) : name_(o.subject), camera_(camera_of(o)) {
  request_.size = parse_size(o.size);
  request_.levels = d.level_filter();
  request_.wrap_u = request_.wrap_v = d.wrap_mode();
  request_.format = d.texels();
  request_.colours = d.colours();
  request_.most_levels = d.most_levels();
  request_.making = d.making();
  if (o.matrix.empty() && o.subject.empty()) throw input_error("nothing to draw: name a scene or model, or give --matrix");
  o.check_consistent();
  nearest_first_ = o.order.empty() ? sim::is_level(name_) : o.order != "file";
  leaves_hidden_ = nearest_first_ && parse_no_skip(d.no_skip).occluded && d.alpha == "opaque" && d.filter != "contour" && d.culled == "none" && d.space == "screen";
  if (!o.matrix.empty()) matrix_ = parse_matrix(o.matrix, request_.size);
  if (!o.texture.empty()) {
    sim::map_list maps;
    maps.push_back(load_map(o.texture, d));
    files_.push_back(o.texture);
    request_.maps = std::make_shared<const sim::map_list>(std::move(maps));
  }
  camera_.skips_outside = (parse_no_skip(d.no_skip).drawing & only(skip::outside)) != 0;
  if (matrix_ || sim::is_scene_name(name_)) return;
  std::error_code ignored;
  if (!std::filesystem::exists(name_, ignored))
    throw input_error(name_ + ": no such model file or scene (known scenes: " + joined(sim::scene_names()) + ")");
  sim::model_options wanted{request_.levels, {}, {}, request_.format, request_.colours, request_.most_levels, request_.making};
  if (d.wrap_given()) wanted.wrap_u = wanted.wrap_v = request_.wrap_u;
  if (!sim::is_level(name_)) {
    world_ = std::make_shared<const sim::world>(sim::load_model(name_, wanted));
    files_ = world_->files;
    find_distance();
    return;
  }
  level_ = std::make_shared<const sim::level>(sim::load_level(name_, o.map, wanted));
  if (!level_->missing.empty() && isatty(STDERR_FILENO) != 0)
    fprintf(stderr, "%s: %zu textures without a picture are grey\n", level_->drawn.name.c_str(), level_->missing.size());
  walks_ = o.camera.empty() && !camera_.eye;
  world_ = std::shared_ptr<const sim::world>(level_, &level_->drawn);
  files_ = world_->files;
  find_distance();
}

// Once for all frames of a turntable.
void subject_options::loaded::find_distance() {
  if (!camera_.eye && !walks_ && camera_.distance_radii == 0) camera_.distance = sim::framing_distance(*world_, camera_, request_.size);
}

sim::camera_options subject_options::loaded::camera_at(double turn_degrees) const {
  sim::camera_options c = camera_;
  c.yaw_degrees += turn_degrees;
  return c;
}

sim::camera_options subject_options::loaded::camera_from(const sim::viewpoint& v) const {
  sim::camera_options c = camera_;
  c.eye = v.eye;
  c.target = v.target;
  return c;
}

sim::scene subject_options::loaded::set_up(const sim::camera_options& from, sim::thread_team* team, faces which) const {
  return sim::look_at(*world_, from, request_.size, {nearest_first_, team, leaves_hidden_ && which == faces::that_may_show});
}

sim::scene subject_options::loaded::at(double turn_degrees, sim::thread_team* team, faces which) const {
  if (matrix_) {
    sim::scene s{"plane", request_.size, sim::plane_maps(request_), {}};
    sim::add_plane(s, *matrix_, 0);
    return s;
  }
  if (walks_) return seen_from(walk(1).front(), team, which);
  if (world_) return set_up(camera_at(turn_degrees), team, which);
  sim::scene_request turned = request_;
  turned.turn_degrees = turn_degrees;
  sim::scene s = sim::make_named_scene(name_, turned);
  if (nearest_first_ && s.uses_depth()) sim::nearest_first(s);
  return s;
}

}  // namespace spantex::tool
