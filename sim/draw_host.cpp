// SPDX-License-Identifier: Apache-2.0
#include "draw_host.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <hal/direct_engine.hpp>
#include <hal/kernels/rows.hpp>
#include <hal/sim_engine.hpp>
#include "object_space_host.hpp"
#include "unchanged.hpp"

namespace spantex::sim {
namespace {

struct band { int32_t y0, y1; };  // pixel rows; whole span rows

// Of the bands that a thread drew.
struct alignas(64) thread_counts {
  draw_counters work;
  skip_counters skipped;
  counters machine;
  uint64_t cycles_of_all_machines = 0, blocks_decoded = 0;
};

bool has_colours(const drawable& item) { return item.colours.varies || !(item.colours.flat == white); }

// A host kernel and the maps made ready for it; null and none where the scalar engine draws.
struct prepared {
  kernels::choice who = kernels::choice::scalar;
  kernels::row_kernel kernel = nullptr;
  kernels::row_cover visible = nullptr;
  std::vector<const kernels::planar_map*> maps;  // null: of no item
};

}  // namespace

kernels::choice kernel_for(const draw_options& o) {
  const profile numbers = profile_of(o.profile, o.changes);
  const kernels::choice kernel = kernels::resolved(o.kernel, numbers);
  const bool draws = kernels::draws(kernel, numbers) && kernels::kernel_of(kernel) != nullptr && o.engine == engine_choice::direct && o.space == sampling_space::screen &&
                     kernels::draws(o.kind) && !o.single_half && o.port == nullptr && o.skips == usual_skips;
  return draws ? kernel : kernels::choice::scalar;
}

namespace {

prepared prepare(const scene& s, const draw_options& o) {
  prepared p;
  p.who = kernel_for(o);
  if (p.who == kernels::choice::scalar) return p;
  p.kernel = kernels::kernel_of(p.who);
  p.visible = kernels::cover_of(p.who);
  p.maps.resize(s.maps->size());
  for (const drawable& item : s.items) {
    const kernels::planar_map*& map = p.maps[size_t(item.map_index)];
    if (map == nullptr) map = &s.map_of(item).planar(kernels::layout_of(p.who));
  }
  return p;
}

int span_rows(const scene& s) { return (s.size.height_px + span_side - 1) / span_side; }

// Planes that kernels plan as a whole, bands that are high enough. Their rows cost alike.
bool planned_as_a_whole(const scene& s, const draw_options& o) {
  const auto is_planned = [&](const drawable& item) {
    return !item.is_polygon && kernels::upright_plane::plans(item.shape.map, o.kind) && (o.kind == filter::nearest || s.map_of(item).view_on_demand().colours() == colour_space::coded);
  };
  const kernels::choice kernel = kernel_for(o);
  return kernel != kernels::choice::scalar && kernel != kernels::choice::pixels && std::all_of(s.items.begin(), s.items.end(), is_planned);
}

// Bands of the picture; each thread's first one, and the end.
struct band_shares {
  std::vector<band> bands;
  std::vector<int> starts;
};

// A simulated machine a thread. The direct engine takes shorter and shorter bands, since some rows, as those near a horizon, cost more than others and a thread that is done helps the
// others: first half of its thread's share (of n threads an n-th, a thread's part if the other shares cost nothing), then a third of what is left each; a band costs as much
// besides as some seven spans.
band_shares make_bands(const scene& s, const draw_options& o) {
  constexpr int least_rows = 4;  // of spans, of bands that plan their columns, each again
  const bool planned = planned_as_a_whole(s, o);
  const int height = s.size.height_px, rows = span_rows(s), most = planned ? rows / least_rows : rows;
  const int shares = std::clamp(o.sink != nullptr ? 1 : o.threads, 1, std::max(1, most));
  const bool whole = shares == 1 || planned || o.engine != engine_choice::direct;
  band_shares made;
  for (int k = 0; k < shares; ++k) {
    made.starts.push_back(int(made.bands.size()));
    const int begin = rows * k / shares, end = rows * (k + 1) / shares;
    for (int first = begin, next; first < end; first = next) {
      next = whole ? end : first + std::max(1, first == begin ? (end - begin) / shares : (end - first) / 3);
      made.bands.push_back({first * span_side, std::min(height, next * span_side)});
    }
  }
  made.starts.push_back(int(made.bands.size()));
  return made;
}

struct target {
  image& picture;
  frame_depths& depth;
  const prepared& ready;
  const std::vector<uint8_t>& kept;  // spans (unchanged.hpp); empty: none
  std::vector<band> rows;            // of pixels, that each item may cover; empty: all of them are in every band
  bool may_cover(size_t item, band b) const { return rows.empty() || (rows[item].y0 < b.y1 && rows[item].y1 > b.y0); }
  int32_t columns() const { return (picture.width_px + span_side - 1) / span_side; }
  depth_buffer depths() const { return depth.values.empty() ? depth_buffer{} : depth_buffer{depth.values.data(), depth.floors.data()}; }
};

// Rows of pixels that each item may cover, so that a band need not read items that lie elsewhere, a thousand bytes each. The engine counts what it leaves out of any item: it is asked
// for all of them.
std::vector<band> rows_of_items(const scene& s, const prepared& ready, const std::vector<band>& bands) {
  std::vector<band> rows;
  if (bands.size() == 1 || ready.kernel == nullptr) return rows;
  rows.reserve(s.items.size());
  for (const drawable& item : s.items) rows.push_back(item.is_polygon ? band{item.shape.box.y0, item.shape.box.y1} : band{0, s.size.height_px});
  return rows;
}

// What is not kept.
void clear(const target& out, band b, rgba8 background) {
  const auto fill = [](auto& values, size_t first, size_t count, auto value) {
    if (!values.empty()) std::fill_n(values.begin() + std::ptrdiff_t(first), count, value);
  };
  const int32_t width = out.picture.width_px;
  if (out.kept.empty()) {
    const size_t rows = size_t(b.y1 - b.y0), first_span = size_t(b.y0 / span_side) * size_t(out.columns()), spans = (rows + span_side - 1) / span_side * size_t(out.columns());
    fill(out.picture.pixels, size_t(b.y0) * size_t(width), rows * size_t(width), background);
    fill(out.depth.values, size_t(b.y0) * size_t(width), rows * size_t(width), 0u);
    fill(out.depth.floors, first_span, spans, 0u);
    return;
  }
  for (int32_t y = b.y0; y < b.y1; ++y)
    for (int32_t sx = 0; sx < out.columns(); ++sx) {
      const size_t span = size_t(y / span_side) * size_t(out.columns()) + size_t(sx), first = size_t(y) * size_t(width) + size_t(sx * span_side);
      if (out.kept[span] != 0) continue;
      const size_t count = size_t(std::min(span_side, width - sx * span_side));
      fill(out.picture.pixels, first, count, background);
      fill(out.depth.values, first, count, 0u);
      fill(out.depth.floors, span, 1, 0u);
    }
}

frame_buffer frame_of(image& picture) { return {picture.pixels.data(), picture.width_px, picture.height_px, picture.width_px}; }

// The item's map as the options read it.
status view_of(const scene& s, const drawable& item, const draw_options& o, texture_view& t) {
  t = s.map_of(item).view_on_demand();
  contour_style style = t.contour();
  style.threshold = o.threshold.value_or(style.threshold);
  style.scale = o.field_scale.value_or(style.scale);
  style.outline = o.outline.value_or(style.outline);
  return t.set_contour(style);
}

// A level is made when the first section of it is read; the engine is told of the upload.
template <class Engine>
struct reads_on_demand : counted_reads {
  Engine* engine = nullptr;
  const texture_map* map = nullptr;  // that is drawn, and the view that is drawn by
  texture_view view;
  void touch(int level) {
    if (const uint64_t words = map->make_level(level); words != 0) engine->mark({event_kind::map_upload, uint32_t(words)});
    view.set_facts(map->facts());
  }
};

status draw_item(auto& renderer, const drawable& item, const scene& s, const draw_options& o, band b, const target& out, draw_counters& counts) {
  const rectangle rows{0, b.y0, s.size.width_px, b.y1};
  shading how = o.how;
  if (has_colours(item)) how.colours = &item.colours;
  const bool by_kernel = out.ready.kernel != nullptr;
  texture_view& map = renderer.reads().view;
  if (!by_kernel || renderer.reads().map != &s.map_of(item)) SPANTEX_TRY(view_of(s, item, o, map));  // of the same map it would be the same, whose levels are all made
  renderer.reads().map = &s.map_of(item);
  if (item.is_polygon) {
    if (by_kernel) {
      SPANTEX_TRY(kernels::draw_polygon(out.ready.kernel, out.ready.visible, *out.ready.maps[size_t(item.map_index)], renderer, item.shape, map, o.kind, rows, out.depths(), frame_of(out.picture), counts, how));
    } else {
      polygon part = item.shape;
      part.box = intersection(part.box, rows);
      SPANTEX_TRY(renderer.draw(part, map, o.kind, out.depths(), how));
    }
    if (o.parts_done) o.parts_done(1);
    return status::ok;
  }
  if (by_kernel) {
    SPANTEX_TRY(kernels::draw_plane(out.ready.kernel, *out.ready.maps[size_t(item.map_index)], renderer, item.shape.map, map, o.kind, rows, frame_of(out.picture), counts, how));
    if (o.parts_done) o.parts_done((b.y1 - b.y0 + span_side - 1) / span_side);
    return status::ok;
  }
  for (int32_t y = b.y0; y < b.y1; y += span_side) {
    SPANTEX_TRY(renderer.draw(item.shape.map, map, o.kind, {0, y, rows.x1, std::min(y + span_side, b.y1)}, how));
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

void add(skip_counters& sum, const skip_counters& c) {
  sum.spans_outside += c.spans_outside;
  sum.spans_below_floor += c.spans_below_floor;
  sum.loads_in_other_half += c.loads_in_other_half;
  sum.jobs_constant += c.jobs_constant;
  sum.spans_constant += c.spans_constant;
  sum.pixels_constant += c.pixels_constant;
  sum.jobs_uniform += c.jobs_uniform;
  sum.jobs_one_texel += c.jobs_one_texel;
  sum.jobs_copied += c.jobs_copied;
  sum.jobs_transparent += c.jobs_transparent;
  sum.pixels_written += c.pixels_written;
  sum.pixels_opaque += c.pixels_opaque;
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

// What is nearest everywhere in the band, before anything is filtered there.
void lay_depths_of(const scene& s, band b, const target& out, draw_counters& counts) {
  const int32_t width = s.size.width_px, columns = out.columns();
  const auto leaves = [&](int32_t sx, int32_t sy) { return !out.kept.empty() && out.kept[size_t(sy * columns + sx)] != 0; };
  for (size_t k = 0; k < s.items.size(); ++k) {
    if (!out.may_cover(k, b)) continue;
    const rectangle rows{0, b.y0, width, b.y1};
    if (out.ready.visible != nullptr) {
      counts.spans_total += kernels::lay_depths(out.ready.visible, s.items[k].shape, rows, out.depths(), width, s.size.height_px, leaves);
      continue;
    }
    polygon part = s.items[k].shape;
    part.box = intersection(part.box, rows);
    counts.spans_total += lay_depths(part, out.depths(), width, s.size.height_px, leaves);
  }
  for (int32_t sy = b.y0 / span_side; sy * span_side < b.y1; ++sy)
    for (int32_t sx = 0; sx < columns; ++sx) {
      if (leaves(sx, sy)) continue;
      reopen_depths(&out.depth.floors[size_t(sy * columns + sx)], 1);
      for (int32_t y = sy * span_side; y < std::min((sy + 1) * span_side, b.y1); ++y)
        reopen_depths(&out.depth.values[size_t(y) * size_t(width) + size_t(sx * span_side)], std::min(span_side, width - sx * span_side));
    }
}

template <class Prof, class Engine>
status draw_band(const Prof& prof, Engine& engine, const scene& s, const draw_options& o, band b, const target& out, thread_counts& counts) {
  for (const texture_map& map : *s.maps)
    if (const uint64_t words = map.words_uploaded(); words != 0) engine.mark({event_kind::map_upload, uint32_t(words)});
  const run_time_skips skips{o.port == nullptr ? o.skips : o.skips & default_skips, {0, b.y0, s.size.width_px, b.y1}, out.kept.empty() ? nullptr : out.kept.data(), out.columns()};
  renderer<Engine, Prof, shading, reads_on_demand<Engine>, run_time_skips> r(engine, prof, frame_of(out.picture), skips, {{}, &engine, nullptr, {}});
  r.single_half(o.single_half);
  if (o.depths_first && s.uses_depth()) lay_depths_of(s, b, out, counts.work);
  int elsewhere = 0;
  for (size_t k = 0; k < s.items.size(); ++k) {
    if (out.may_cover(k, b)) SPANTEX_TRY(draw_item(r, s.items[k], s, o, b, out, counts.work));
    else ++elsewhere;
  }
  if (o.parts_done && elsewhere != 0) o.parts_done(elsewhere);
  SPANTEX_TRY(r.finish());
  add(counts.work, r.counters());
  add(counts.skipped, r.skipped());
  counts.blocks_decoded += r.reads().blocks_decoded;
  return status::ok;
}

template <class Prof, int Fine = Prof::max_fine_side>
status draw_band_with(const Prof& prof, const scene& s, const draw_options& o, band b, const target& out, thread_counts& counts) {
  if (o.port != nullptr) return draw_band(prof, *o.port, s, o, b, out, counts);
  if (o.engine == engine_choice::direct) {
    direct_engine<Prof, Fine> engine(prof);
    return draw_band(prof, engine, s, o, b, out, counts);
  }
  const auto engine = std::make_unique<sim_engine<Prof, Fine>>(prof, o.table, o.sink);
  SPANTEX_TRY(draw_band(prof, *engine, s, o, b, out, counts));
  add(counts.machine, engine->counters());
  counts.cycles_of_all_machines += engine->counters().total_cycles;
  return status::ok;
}

// The local memory is the profile's.
status draw_band_at_run_time(const run_time_profile& prof, const scene& s, const draw_options& o, band b, const target& out, thread_counts& counts) {
  switch (prof.value.fine_side) {
    case 8: return draw_band_with<run_time_profile, 8>(prof, s, o, b, out, counts);
    case 16: return draw_band_with<run_time_profile, 16>(prof, s, o, b, out, counts);
    default: return draw_band_with<run_time_profile, 32>(prof, s, o, b, out, counts);
  }
}

status draw_band_by_profile(const scene& s, const draw_options& o, band b, const target& out, thread_counts& counts) {
  if (o.changes.any()) return draw_band_at_run_time({profile_of(o.profile, o.changes)}, s, o, b, out, counts);
  switch (o.profile) {
    case profile_choice::seed: return draw_band_with(fixed_profile<profiles::seed>{}, s, o, b, out, counts);
    case profile_choice::compact: return draw_band_with(fixed_profile<profiles::compact>{}, s, o, b, out, counts);
    case profile_choice::standard: return draw_band_with(fixed_profile<profiles::standard>{}, s, o, b, out, counts);
    case profile_choice::exact: return draw_band_with(fixed_profile<profiles::exact>{}, s, o, b, out, counts);
  }
  return status::out_of_range;
}

// One repetition; the time of drawing alone.
double draw_once(const scene& s, const draw_options& o, const prepared& ready, const std::vector<uint8_t>& kept, const band_shares& shares, thread_team& team,
                 draw_result& result, frame_depths& depth) {
  const std::vector<band>& bands = shares.bands;
  std::vector<thread_counts> counts(size_t(team.size()));
  target out{result.picture, depth, ready, kept, {}};
  team.run_by_shares(shares.starts, [&](int k, int) { clear(out, bands[size_t(k)], o.background); });
  const auto begun = std::chrono::steady_clock::now();
  out.rows = rows_of_items(s, ready, bands);
  team.run_by_shares(shares.starts, [&](int k, int thread) {
    const status done = draw_band_by_profile(s, o, bands[size_t(k)], out, counts[size_t(thread)]);
    if (done != status::ok) throw input_error(s.name + ": " + to_string(done));
  });
  const double ns = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begun).count();
  result.work = {};
  result.skipped = {};
  result.machine = {};
  result.blocks_decoded = 0;
  result.machines = int(bands.size());
  result.cycles_of_all_machines = 0;
  for (const thread_counts& c : counts) {
    add(result.work, c.work);
    add(result.skipped, c.skipped);
    add(result.machine, c.machine);
    result.blocks_decoded += c.blocks_decoded;
    result.cycles_of_all_machines += c.cycles_of_all_machines;
  }
  return ns;
}

}  // namespace

namespace {

// Planes are cut into bands of depth, as one polygon the nearest part would set the pitch of all.
constexpr double depth_ratio_of_bands = 2;

double draw_in_object_space(const scene& s, const draw_options& options, draw_result& result) {
  for (const texture_map& map : *s.maps)
    if (map.view_on_demand().colours() == colour_space::srgb) throw input_error("object space: spreads coded colours: not with an sRGB map");
  for (const texture_map& map : *s.maps)
    for (int k = 0; k < map.level_count(); ++k) map.make_level(k);
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
  p.sample_spacing = changes.sample_spacing.value_or(p.sample_spacing);
  p.sample_slack = changes.sample_slack.value_or(p.sample_slack);
  p.sample_bias = changes.sample_bias.value_or(p.sample_bias);
  if (!is_valid(p)) throw input_error("profile: numbers outside their documented ranges");
  return p;
}

namespace {

// What is left of the scene: made in `kept`, or the scene itself.
const scene& without_culled(const scene& s, cull culled, scene& kept) {
  if (culled == cull::none) return s;
  kept = s;
  std::erase_if(kept.items, [&](const drawable& item) { return item.is_polygon && item.shape.front_facing == (culled == cull::clockwise); });
  return kept;
}

}  // namespace

draw_result draw(const scene& all, const draw_options& options, frame_before* before) {
  scene kept_items;
  const scene& s = without_culled(all, options.culled, kept_items);
  draw_result result;
  result.polygons_outside = s.polygons_outside;
  result.polygons_hidden = s.polygons_hidden;
  result.polygons_culled = int(all.items.size() - s.items.size());
  result.picture = image(s.size.width_px, s.size.height_px, options.background);
  if (!s.maps->empty()) result.format = s.maps->front().view_on_demand().format();
  if (!s.maps->empty()) result.colours = s.maps->front().view_on_demand().colours();
  frame_depths depth;
  if (s.uses_depth()) {
    const auto spans = [](int px) { return size_t(px + span_side - 1) / span_side; };
    depth.values.resize(result.picture.pixels.size());
    depth.floors.resize(spans(s.size.width_px) * spans(s.size.height_px));
  }
  const auto begun = std::chrono::steady_clock::now();
  const bool keeps = before != nullptr && options.space == sampling_space::screen && options.port == nullptr;
  const std::vector<uint8_t> kept = keeps ? before->unchanged(s, options) : std::vector<uint8_t>();
  if (!kept.empty()) {
    result.spans_unchanged = int(std::count(kept.begin(), kept.end(), 1));
    result.picture = before->picture();
    depth = before->depth();
  }
  const double ns_to_compare = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begun).count();
  const band_shares shares = make_bands(s, options);
  std::optional<thread_team> own;
  if (options.team == nullptr) own.emplace(int(shares.starts.size()) - 1);
  thread_team& team = options.team == nullptr ? *own : *options.team;
  const prepared ready = prepare(s, options);
  if (ready.kernel != nullptr) result.kernel = name_of(kernel_names, ready.who);
  std::vector<double> times;
  for (int k = 0; k < std::max(1, options.repeat); ++k)
    times.push_back(options.space == sampling_space::object ? draw_in_object_space(s, options, result)
                                                            : ns_to_compare + draw_once(s, options, ready, kept, shares, team, result, depth));
  if (ready.kernel != nullptr && options.counted) {
    const image by_kernel = result.picture;
    draw_options quiet = options;
    quiet.parts_done = nullptr;
    draw_once(s, quiet, {}, kept, shares, team, result, depth);
    if (by_kernel.pixels != result.picture.pixels) throw std::logic_error(s.name + ": kernel and engine differ");
  }
  std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(times.size() / 2), times.end());
  result.ns_per_pixel = times[times.size() / 2] / double(result.picture.pixels.size());
  for (const texture_map& map : *s.maps) {
    result.words_uploaded += map.words_uploaded();
    result.levels_left_out += map.levels_left_out();
  }
  if (keeps) before->keep(s, options, result.picture, depth);
  return result;
}

int draw_parts(const scene& all, const draw_options& options) {
  if (options.space == sampling_space::object) return 0;
  scene kept_items;
  const scene& s = without_culled(all, options.culled, kept_items);
  const int bands = int(make_bands(s, options).bands.size()), rows = span_rows(s);
  int parts = 0;
  for (const drawable& item : s.items) parts += item.is_polygon ? bands : rows;
  return parts * std::max(1, options.repeat);
}

}  // namespace spantex::sim
