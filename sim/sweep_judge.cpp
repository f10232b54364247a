// SPDX-License-Identifier: Apache-2.0
#include "sweep_judge.hpp"

#include <math.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include <hal/direct_engine.hpp>
#include <hal/sim_engine.hpp>
#include <spantex/draw.hpp>
#include "quality.hpp"
#include "sweep_watch.hpp"

namespace spantex::sim {
namespace {

struct column_banks {
  static constexpr int bank(int x, int) { return x & 3; }
};

struct drawn {
  image picture;
  draw_counters work{};
  counters machine{};
  double ns = 0;
};

// Draws a scene on an engine; a watch is told of every plane before its spans.
template <class Engine>
void draw_on(Engine& engine, const sweep_point& p, const scene& s, span_watch* watch, drawn& out) {
  out.picture = image(s.size.width_px, s.size.height_px, sweep_background);
  std::vector<uint32_t> depth(s.uses_depth() ? out.picture.pixels.size() : 0);
  shading how{};
  if (p.kind == filter::contour) how.alpha = alpha_mode::blended;
  const auto begun = std::chrono::steady_clock::now();
  renderer<Engine, run_time_profile, shading, counted_reads> r(engine, p.machine, {out.picture.pixels.data(), s.size.width_px, s.size.height_px, s.size.width_px});
  r.single_half(p.single_half);
  const auto checked = [&](status done) {
    if (done != status::ok) throw input_error(s.name + ": " + to_string(done));
  };
  for (const drawable& item : s.items) {
    if (watch != nullptr) watch->about(item.shape.map);
    if (item.is_polygon) checked(r.draw(item.shape, s.texture(item), p.kind, {depth.data()}, how));
    else checked(r.draw(item.shape.map, s.texture(item), p.kind, rectangle{0, 0, s.size.width_px, s.size.height_px}, how));
  }
  checked(r.finish());
  out.ns = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begun).count();
  out.work = r.counters();
}

template <int Fine, class Banks>
drawn simulated(const sweep_point& p, const scene& s, span_watch* watch) {
  const auto engine = std::make_unique<watched_engine<sim_engine<run_time_profile, Fine, Banks>>>(watch, p.machine, p.table);
  drawn d;
  draw_on(*engine, p, s, watch, d);
  d.machine = engine->engine().counters();
  return d;
}

template <int Fine>
drawn direct(const sweep_point& p, const scene& s) {
  const auto engine = std::make_unique<direct_engine<run_time_profile, Fine>>(p.machine);
  drawn d;
  draw_on(*engine, p, s, nullptr, d);
  return d;
}

drawn simulate(const sweep_point& p, const scene& s, span_watch* watch) {
  const bool parity = p.banks == bank_map::parity;
  switch (p.machine.value.fine_side) {
    case 8: return parity ? simulated<8, parity_banks>(p, s, watch) : simulated<8, column_banks>(p, s, watch);
    case 16: return parity ? simulated<16, parity_banks>(p, s, watch) : simulated<16, column_banks>(p, s, watch);
    default: return parity ? simulated<32, parity_banks>(p, s, watch) : simulated<32, column_banks>(p, s, watch);
  }
}

drawn draw_directly(const sweep_point& p, const scene& s) {
  switch (p.machine.value.fine_side) {
    case 8: return direct<8>(p, s);
    case 16: return direct<16>(p, s);
    default: return direct<32>(p, s);
  }
}

// The same method with the longest words, levels a pixel and sections that hold everything.
sweep_point twin_of(sweep_point p) {
  profile longest = profiles::exact;
  const profile& q = p.machine.value;
  longest.formula = q.formula;
  longest.level_bias = q.level_bias;
  longest.mip_bias = q.mip_bias;
  longest.max_samples = q.max_samples;
  longest.sample_spacing = q.sample_spacing;
  longest.sample_slack = q.sample_slack;
  longest.sample_bias = q.sample_bias;
  longest.area_side_log2 = q.area_side_log2;
  longest.linear_light = q.linear_light;
  longest.tolerance_bits = 16;
  p.machine = {longest, {.order = evaluation_order::divide}};
  return p;
}

std::string name_of_twin(const sweep_point& p, int frame) {
  const profile& q = p.machine.value;
  std::string name = name_of(p.subject, frame);
  for (const int n : {int(p.kind), int(q.formula), q.level_bias, q.mip_bias, q.max_samples, q.sample_spacing, q.sample_slack, q.sample_bias, q.area_side_log2, int(q.linear_light)})
    name += "|" + std::to_string(n);
  return name;
}

std::shared_ptr<const image> twin_picture(const sweep_point& p, int frame, sweep_subjects& subjects) {
  return subjects.twin_of(name_of_twin(p, frame), [&] {
    const sweep_point twin = twin_of(p);
    return draw_directly(twin, *subjects.scene_of(twin.subject, frame)).picture;
  });
}

std::array<double, 3> colours(rgba8 c) { return {double(c.r), double(c.g), double(c.b)}; }

double rms_of(double squares, size_t pixels) { return sqrt(squares / double(3 * pixels)); }

// Ottosson's OKLab of coded sRGB (bottosson.github.io/posts/oklab), 2020.
std::array<double, 3> oklab(rgba8 c) {
  const double r = srgb_decoded(c.r) / 65535.0, g = srgb_decoded(c.g) / 65535.0, b = srgb_decoded(c.b) / 65535.0;
  const double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b), m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b),
               s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s, 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

// Mean distance in OKLab times 100.
double oklab_difference(const image& a, const image& b) {
  double sum = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    if (a.pixels[k] == b.pixels[k]) continue;
    const auto x = oklab(a.pixels[k]), y = oklab(b.pixels[k]);
    sum += sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
  }
  return 100 * sum / double(a.pixels.size());
}

void judge_picture(const image& picture, const sweep_reference& reference, sweep_result& r) {
  double squares = 0, worst = 0;
  for (size_t k = 0; k < picture.pixels.size(); ++k) {
    const auto c = colours(picture.pixels[k]);
    for (size_t n = 0; n < 3; ++n) {
      const double d = c[n] - reference.ideal.pixels[k][n];
      squares += d * d;
      worst = std::max(worst, fabs(d));
    }
  }
  r[measure::psnr_db] = psnr_db(picture, reference.ideal);
  r[measure::ssim] = ssim(picture, reference.rounded);
  r[measure::oklab] = oklab_difference(picture, reference.rounded);
  r[measure::rms_lsb] = rms_of(squares, picture.pixels.size());
  r[measure::worst_lsb] = worst;
}

// Mean step of the error between neighbours on both sides of a span's border over that within spans; both of one surface.
double border_ratio(const image& a, const image& b, const std::vector<int>& items, int side) {
  double sum[2] = {};
  uint64_t count[2] = {};
  const int width = a.width_px, height = a.height_px;
  const auto step = [&](int x, int y, int dx, int dy) {
    const size_t k = size_t(y) * size_t(width) + size_t(x), n = k + size_t(dy) * size_t(width) + size_t(dx);
    if (items[k] < 0 || items[k] != items[n]) return;
    const bool border = (dx != 0 ? x : y) % side == side - 1;
    const auto p = colours(a.pixels[k]), q = colours(a.pixels[n]), u = colours(b.pixels[k]), v = colours(b.pixels[n]);
    for (size_t c = 0; c < 3; ++c) sum[border] += fabs((p[c] - u[c]) - (q[c] - v[c]));
    count[border] += 3;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) step(x, y, 1, 0);
      if (y + 1 < height) step(x, y, 0, 1);
    }
  if (count[0] == 0 || count[1] == 0 || sum[0] == 0) return std::numeric_limits<double>::quiet_NaN();
  return sum[1] / double(count[1]) / (sum[0] / double(count[0]));
}

void judge_twin(const image& picture, const image& twin, const std::vector<int>& items, int side, sweep_result& r) {
  double squares = 0, worst = 0;
  for (size_t k = 0; k < picture.pixels.size(); ++k) {
    const auto c = colours(picture.pixels[k]), t = colours(twin.pixels[k]);
    for (size_t n = 0; n < 3; ++n) {
      squares += (c[n] - t[n]) * (c[n] - t[n]);
      worst = std::max(worst, fabs(c[n] - t[n]));
    }
  }
  r[measure::twin_psnr_db] = psnr_db(picture, twin);
  r[measure::twin_rms_lsb] = rms_of(squares, picture.pixels.size());
  r[measure::twin_worst_lsb] = worst;
  r[measure::border_ratio] = border_ratio(picture, twin, items, side);
}

void judge_cost(const drawn& d, const span_watch& watch, const sweep_point& p, sweep_result& r) {
  const double pixels = double(std::max<uint64_t>(1, d.work.pixels));
  r[measure::cycles_per_pixel] = double(d.machine.total_cycles) / pixels;
  r[measure::stalls_per_pixel] = double(d.machine.stall_cycles) / pixels;
  r[measure::conflicts_per_pixel] = double(d.machine.bank_conflicts) / channel_count / pixels;
  r[measure::words_per_pixel] = double(d.work.words_loaded) / pixels;
  r[measure::reads_per_pixel] = double(d.work.words_read) / pixels;
  r[measure::jobs_per_pixel] = double(d.work.jobs) / pixels;
  r[measure::divides_per_pixel] = double(d.work.divides) / pixels;
  r[measure::short_products_per_pixel] = double(watch.products.short_ones) / pixels;
  r[measure::long_products_per_pixel] = double(watch.products.long_ones) / pixels;
  r[measure::product_bits_per_pixel] = double(watch.products.bits) / pixels;
  r[measure::memory_bits] = memory_bits(p.machine.value);
  r[measure::word_bits] = word_bits(p.machine.value);
}

void judge_coordinates(const span_watch& watch, sweep_result& r) {
  if (watch.coordinate.count != 0) {
    r[measure::coordinate_rms_texels] = watch.coordinate.rms();
    r[measure::coordinate_worst_texels] = watch.coordinate.worst;
  }
  if (watch.level.count != 0) r[measure::level_worst] = watch.level.worst;
}

// Root mean square, over pixels and pairs of frames, of the change of the picture's error from one frame to the next.
void judge_motion(const sweep_point& p, bool has_reference, sweep_subjects& subjects, sweep_result& r) {
  const size_t pixels = size_t(p.subject.size.width_px) * size_t(p.subject.size.height_px);
  std::vector<std::array<double, 3>> error(pixels), twin_error(pixels);
  double squares = 0, twin_squares = 0;
  for (int frame = 0; frame < p.subject.frames; ++frame) {
    const image picture = draw_directly(p, *subjects.scene_of(p.subject, frame)).picture;
    const std::shared_ptr<const sweep_reference> reference = has_reference ? subjects.reference_of(p.subject, frame) : nullptr;
    const std::shared_ptr<const image> twin = twin_picture(p, frame, subjects);
    for (size_t k = 0; k < pixels; ++k) {
      const auto c = colours(picture.pixels[k]), t = colours(twin->pixels[k]);
      for (size_t n = 0; n < 3; ++n) {
        const double e = has_reference ? c[n] - reference->ideal.pixels[k][n] : 0, f = c[n] - t[n];
        if (frame > 0) {
          squares += (e - error[k][n]) * (e - error[k][n]);
          twin_squares += (f - twin_error[k][n]) * (f - twin_error[k][n]);
        }
        error[k][n] = e;
        twin_error[k][n] = f;
      }
    }
  }
  const size_t pairs = pixels * size_t(std::max(1, p.subject.frames - 1));
  if (has_reference) r[measure::swim_lsb] = rms_of(squares, pairs);
  r[measure::twin_swim_lsb] = rms_of(twin_squares, pairs);
}

}  // namespace

int memory_bits(const profile& p) {
  constexpr int base_bits = 17, term_bits = 16;
  const int texels = (p.fine_side * p.fine_side + p.coarse_side() * p.coarse_side()) * 8 * channel_count;
  const int coefficients = 2 * base_bits + 6 * (p.offset_bits + 1) + 2 * (p.reciprocal_bits - 2) + 2 * span_side * term_bits;
  return half_count * (texels + coefficients);
}

int word_bits(const profile& p) { return p.coordinate_bits + p.offset_bits + p.reciprocal_bits + p.subtexel_bits + p.level_bits + p.blend_bits; }

image picture_of(const sweep_point& p, sweep_subjects& subjects) { return draw_directly(p, *subjects.scene_of(p.subject, 0)).picture; }

sweep_result judge(const sweep_point& p, const measure_groups& wanted, sweep_subjects& subjects) {
  sweep_result r;
  const std::shared_ptr<const scene> s = subjects.scene_of(p.subject, 0);
  span_watch watch(p.machine);
  const drawn d = simulate(p, *s, &watch);
  // A coverage has no picture to be compared with.
  const bool has_reference = p.kind != filter::contour;
  if (wanted.has(measure_group::picture) && has_reference) judge_picture(d.picture, *subjects.reference_of(p.subject, 0), r);
  if (wanted.has(measure_group::twin))
    judge_twin(d.picture, *twin_picture(p, 0, subjects), visible_items(*s), 1 << p.machine.units.span_log2, r);
  if (wanted.has(measure_group::coordinates)) judge_coordinates(watch, r);
  if (wanted.has(measure_group::cost)) judge_cost(d, watch, p, r);
  if (wanted.has(measure_group::motion) && p.subject.motion != camera_motion::none) judge_motion(p, has_reference, subjects, r);
  if (wanted.has(measure_group::time)) r[measure::ns_per_pixel] = draw_directly(p, *s).ns / double(std::max<uint64_t>(1, d.work.pixels));
  return r;
}

}  // namespace spantex::sim
