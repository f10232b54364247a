// SPDX-License-Identifier: Apache-2.0
#include "draw_host.hpp"

#include <algorithm>
#include <chrono>
#include <memory>

#include <hal/direct_engine.hpp>
#include <hal/kernels/rows.hpp>
#include <hal/sim_engine.hpp>
#include "object_space_host.hpp"

namespace spantex::sim {
namespace {

struct band { int32_t y0, y1; };  // pixel rows; whole span rows

std::vector<band> make_bands(int height, int threads) {
  const int rows = (height + span_side - 1) / span_side, count = std::clamp(threads, 1, rows);
  std::vector<band> bands;
  for (int k = 0; k < count; ++k)
    bands.push_back({rows * k / count * span_side, std::min(height, rows * (k + 1) / count * span_side)});
  return bands;
}

struct band_counts {
  draw_counters work;
  counters machine;
};

// A host kernel and the maps made ready for it; null and none where the scalar engine draws.
struct prepared {
  kernels::row_kernel kernel = nullptr;
  std::vector<kernels::planar_map> maps;
};

prepared prepare(const scene& s, const draw_options& o) {
  const bool wanted = o.profile == profile_choice::standard && o.engine == engine_choice::direct && o.space == sampling_space::screen && kernels::draws(o.kernel, o.kind) &&
                      !o.single_half && o.port == nullptr && o.changes == profile_changes{} && o.how.alpha == alpha_mode::opaque && o.how.colour == white &&
                      (o.kind == filter::nearest || std::all_of(s.maps->begin(), s.maps->end(), [](const texture_map& map) {
                         return map.view().colours() == colour_space::coded;
                       }));
  prepared p;
  if (!wanted) return p;
  p.kernel = kernels::kernel_of(o.kernel);
  if (p.kernel != nullptr)
    for (const texture_map& map : *s.maps) p.maps.emplace_back(map.view(), kernels::layout_of(o.kernel));
  return p;
}

struct frame_depths {
  std::vector<uint32_t> values, floors;  // empty where no polygon is drawn
};

struct target {
  image& picture;
  frame_depths& depth;
  const prepared& ready;
  depth_buffer depths() const { return depth.values.empty() ? depth_buffer{} : depth_buffer{depth.values.data(), depth.floors.data()}; }
};

frame_buffer frame_of(image& picture) { return {picture.pixels.data(), picture.width_px, picture.height_px, picture.width_px}; }

// The item's map as the options read it.
status view_of(const scene& s, const drawable& item, const draw_options& o, texture_view& t) {
  t = s.texture(item);
  contour_style style = t.contour();
  style.threshold = o.threshold.value_or(style.threshold);
  style.scale = o.field_scale.value_or(style.scale);
  style.outline = o.outline.value_or(style.outline);
  return t.set_contour(style);
}

status draw_item(auto& renderer, const drawable& item, const scene& s, const draw_options& o, band b, const target& out, draw_counters& counts) {
  const rectangle rows{0, b.y0, s.size.width_px, b.y1};
  texture_view map;
  SPANTEX_TRY(view_of(s, item, o, map));
  shading how = o.how;
  if (item.colours.varies || !(item.colours.flat == white)) how.colours = &item.colours;
  if (item.is_polygon) {
    polygon part = item.shape;
    part.box = intersection(part.box, rows);
    if (out.ready.kernel != nullptr && how.colours == nullptr)
      SPANTEX_TRY(kernels::draw_polygon(out.ready.kernel, out.ready.maps[size_t(item.map_index)], renderer, part, map, o.kind, out.depths(), frame_of(out.picture), counts, how));
    else if (!part.box.empty())
      SPANTEX_TRY(renderer.draw(part, map, o.kind, out.depths(), how));
    if (o.parts_done) o.parts_done(1);
    return status::ok;
  }
  for (int32_t y = b.y0; y < b.y1; y += span_side) {
    const rectangle row{0, y, rows.x1, std::min(y + span_side, b.y1)};
    if (out.ready.kernel != nullptr && how.colours == nullptr)
      SPANTEX_TRY(kernels::draw_plane(out.ready.kernel, out.ready.maps[size_t(item.map_index)], renderer, item.shape.map, map, o.kind, row, frame_of(out.picture), counts, how));
    else
      SPANTEX_TRY(renderer.draw(item.shape.map, map, o.kind, row, how));
    if (o.parts_done) o.parts_done(1);
  }
  return status::ok;
}

void add(draw_counters& sum, const draw_counters& c) {
  sum.spans_total += c.spans_total;
  sum.spans_empty += c.spans_empty;
  sum.spans_behind += c.spans_behind;
  sum.spans_hidden += c.spans_hidden;
  sum.jobs += c.jobs;
  sum.pixels += c.pixels;
  sum.words_loaded += c.words_loaded;
  sum.words_read += c.words_read;
  sum.loads_skipped += c.loads_skipped;
  sum.second_levels_skipped += c.second_levels_skipped;
  sum.divides += c.divides;
  sum.affine_jobs += c.affine_jobs;
  sum.series_jobs += c.series_jobs;
  sum.divide_jobs += c.divide_jobs;
  sum.corrected_jobs += c.corrected_jobs;
  sum.pixels_left += c.pixels_left;
  sum.pixels_blended += c.pixels_blended;
}

template <class Prof, class Engine>
status draw_band(const Prof& prof, Engine& engine, const scene& s, const draw_options& o, band b, const target& out, draw_counters& work) {
  for (const texture_map& map : *s.maps) engine.mark({event_kind::map_upload, uint32_t(map.words_uploaded())});
  renderer<Engine, Prof, shading, counted_reads> r(engine, prof, {out.picture.pixels.data(), s.size.width_px, s.size.height_px, s.size.width_px});
  r.single_half(o.single_half);
  for (const drawable& item : s.items) SPANTEX_TRY(draw_item(r, item, s, o, b, out, work));
  SPANTEX_TRY(r.finish());
  add(work, r.counters());
  return status::ok;
}

template <class Prof, int Fine = Prof::max_fine_side>
status draw_band_with(const Prof& prof, const scene& s, const draw_options& o, band b, const target& out, band_counts& counts) {
  if (o.port != nullptr) return draw_band(prof, *o.port, s, o, b, out, counts.work);
  if (o.engine == engine_choice::direct) {
    const auto engine = std::make_unique<direct_engine<Prof, Fine>>(prof);
    return draw_band(prof, *engine, s, o, b, out, counts.work);
  }
  const auto engine = std::make_unique<sim_engine<Prof, Fine>>(prof, o.table, o.sink);
  SPANTEX_TRY(draw_band(prof, *engine, s, o, b, out, counts.work));
  counts.machine = engine->counters();
  return status::ok;
}

// The local memory is the profile's.
status draw_band_at_run_time(const run_time_profile& prof, const scene& s, const draw_options& o, band b, const target& out, band_counts& counts) {
  switch (prof.value.fine_side) {
    case 8: return draw_band_with<run_time_profile, 8>(prof, s, o, b, out, counts);
    case 16: return draw_band_with<run_time_profile, 16>(prof, s, o, b, out, counts);
    default: return draw_band_with<run_time_profile, 32>(prof, s, o, b, out, counts);
  }
}

status draw_band_by_profile(const scene& s, const draw_options& o, band b, const target& out, band_counts& counts) {
  if (o.changes.any()) return draw_band_at_run_time({profile_of(o.profile, o.changes)}, s, o, b, out, counts);
  switch (o.profile) {
    case profile_choice::seed: return draw_band_with(fixed_profile<profiles::seed>{}, s, o, b, out, counts);
    case profile_choice::compact: return draw_band_with(fixed_profile<profiles::compact>{}, s, o, b, out, counts);
    case profile_choice::standard: return draw_band_with(fixed_profile<profiles::standard>{}, s, o, b, out, counts);
    case profile_choice::exact: return draw_band_with(fixed_profile<profiles::exact>{}, s, o, b, out, counts);
  }
  return status::out_of_range;
}

void add(counters& sum, const counters& c) {
  sum.total_cycles = later(sum.total_cycles, c.total_cycles);
  sum.load_cycles += c.load_cycles;
  sum.compute_cycles += c.compute_cycles;
  sum.hidden_load_cycles += c.hidden_load_cycles;
  sum.stall_cycles += c.stall_cycles;
  sum.words_loaded += c.words_loaded;
  sum.fetches += c.fetches;
  sum.texel_reads += c.texel_reads;
  sum.bank_conflicts += c.bank_conflicts;
  sum.jobs += c.jobs;
  sum.pixels += c.pixels;
}

// One repetition; the time of drawing alone.
double draw_once(const scene& s, const draw_options& o, const prepared& ready, const std::vector<band>& bands, draw_result& result, frame_depths& depth) {
  std::fill(result.picture.pixels.begin(), result.picture.pixels.end(), o.background);
  std::fill(depth.values.begin(), depth.values.end(), 0);
  std::fill(depth.floors.begin(), depth.floors.end(), 0);
  std::vector<band_counts> counts(bands.size());
  const target out{result.picture, depth, ready};
  const auto begun = std::chrono::steady_clock::now();
  for_each_index(int(bands.size()), int(bands.size()), [&](int k) {
    const status done = draw_band_by_profile(s, o, bands[size_t(k)], out, counts[size_t(k)]);
    if (done != status::ok) throw input_error(s.name + ": " + to_string(done));
  });
  const double ns = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begun).count();
  result.work = {};
  result.machine = {};
  result.machines = int(bands.size());
  result.cycles_of_all_machines = 0;
  for (const band_counts& c : counts) {
    add(result.work, c.work);
    add(result.machine, c.machine);
    result.cycles_of_all_machines += c.machine.total_cycles;
  }
  return ns;
}

}  // namespace

namespace {

// Planes are cut into bands of depth, as one polygon the nearest part would set the pitch of all.
constexpr double depth_ratio_of_bands = 2;

double draw_in_object_space(const scene& s, const draw_options& options, draw_result& result) {
  for (const texture_map& map : *s.maps)
    if (map.view().colours() == colour_space::srgb) throw input_error("object space: spreads coded colours: not with an sRGB map");
  object_space_options o;
  o.profile = options.profile;
  o.kind = options.kind;
  o.background = options.background;
  o.band_ratio = depth_ratio_of_bands;
  const auto begun = std::chrono::steady_clock::now();
  object_space_result r = render_object_space(s, o);
  const double ns = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begun).count();
  result.picture = std::move(r.picture);
  result.work = r.texturing;
  result.machine.texel_reads = r.texel_reads;
  result.items_left_out = r.items_left_out;
  return ns;
}

}  // namespace

profile profile_of(profile_choice choice, const profile_changes& changes) {
  constexpr profile all[] = {profiles::seed, profiles::compact, profiles::standard, profiles::exact};
  profile p = all[size_t(choice)];
  p.formula = changes.level.value_or(p.formula);
  p.max_samples = changes.max_samples.value_or(p.max_samples);
  p.sample_slack = changes.sample_slack.value_or(p.sample_slack);
  p.sample_bias = changes.sample_bias.value_or(p.sample_bias);
  if (!is_valid(p)) throw input_error("profile: numbers outside their documented ranges");
  return p;
}

draw_result draw(const scene& s, const draw_options& options) {
  draw_result result;
  result.picture = image(s.size.width_px, s.size.height_px, options.background);
  if (!s.maps->empty()) result.format = s.maps->front().view().format();
  if (!s.maps->empty()) result.colours = s.maps->front().view().colours();
  for (const texture_map& map : *s.maps) result.words_uploaded += map.words_uploaded();
  frame_depths depth;
  if (s.uses_depth()) {
    const auto spans = [](int px) { return size_t(px + span_side - 1) / span_side; };
    depth.values.resize(result.picture.pixels.size());
    depth.floors.resize(spans(s.size.width_px) * spans(s.size.height_px));
  }
  const std::vector<band> bands = make_bands(s.size.height_px, options.sink != nullptr ? 1 : options.threads);
  const prepared ready = prepare(s, options);
  if (ready.kernel != nullptr) result.kernel = name_of(kernel_names, kernels::resolved(options.kernel));
  std::vector<double> times;
  for (int k = 0; k < std::max(1, options.repeat); ++k) 
    times.push_back(options.space == sampling_space::object ? draw_in_object_space(s, options, result) : draw_once(s, options, ready, bands, result, depth));
  if (ready.kernel != nullptr && options.counted) {
    const image by_kernel = result.picture;
    draw_options quiet = options;
    quiet.parts_done = nullptr;
    draw_once(s, quiet, {}, bands, result, depth);
    if (by_kernel.pixels != result.picture.pixels) throw std::logic_error(s.name + ": kernel and engine differ");
  }
  std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(times.size() / 2), times.end());
  result.ns_per_pixel = times[times.size() / 2] / double(result.picture.pixels.size());
  return result;
}

int draw_parts(const scene& s, const draw_options& options) {
  if (options.space == sampling_space::object) return 0;
  const int bands = int(make_bands(s.size.height_px, options.threads).size()), rows = (s.size.height_px + span_side - 1) / span_side;
  int parts = 0;
  for (const drawable& item : s.items) parts += item.is_polygon ? bands : rows;
  return parts * std::max(1, options.repeat);
}

}  // namespace spantex::sim
