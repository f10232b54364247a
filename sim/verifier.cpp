// SPDX-License-Identifier: Apache-2.0
#include "sim/verifier.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <spantex/footprint.hpp>

#include "sim/exact.hpp"

namespace spantex::sim {
namespace {

using colour = std::array<double, channel_count>;

colour colour_of(rgba8 c) { return {double(c.r), double(c.g), double(c.b), double(c.a)}; }

struct interval {
  double low, high;
  double middle() const { return (low + high) / 2; }
  double half() const { return (high - low) / 2; }
};

// One 2x2 of a level, and the part of it that the position may lie in: fractions in [0, 1].
struct patch {
  colour t[4];  // (0,0) (1,0) (0,1) (1,1)
  interval x, y;
};

double blend(const patch& p, bool three, int channel, double x, double y) {
  const double a = p.t[0][channel], b = p.t[1][channel], c = p.t[2][channel], d = p.t[3][channel];
  if (!three) return (1 - y) * ((1 - x) * a + x * b) + y * ((1 - x) * c + x * d);
  return y >= x ? x * d + (y - x) * c + (1 - y) * a : y * d + (x - y) * b + (1 - x) * a;
}

double contrast(const patch& p, int channel) {
  const auto [low, high] = std::minmax({p.t[0][channel], p.t[1][channel], p.t[2][channel], p.t[3][channel]});
  return high - low;
}

// Everything one pixel may be made of: a patch per level and a weight between them.
struct candidate {
  patch fine, coarse;
  interval level;
  bool two;
};

// Halves the widest of the five intervals.
void halve(const candidate& c, candidate& a, candidate& b) {
  a = b = c;
  const std::array<double, 5> width{c.fine.x.half(), c.fine.y.half(), c.two ? c.coarse.x.half() : 0, c.two ? c.coarse.y.half() : 0,
                                    c.two ? c.level.half() : 0};
  const auto widest = std::max_element(width.begin(), width.end()) - width.begin();
  const auto part = [&](candidate& k) -> interval& {
    switch (widest) {
      case 0: return k.fine.x;
      case 1: return k.fine.y;
      case 2: return k.coarse.x;
      case 3: return k.coarse.y;
      default: return k.level;
    }
  };
  part(a).high = part(b).low = part(a).middle();
}

// Is there a point in the candidate whose four channels all lie within the threshold of the pixel? Bounded by how fast the blend can
// change, so a refusal is certain; an acceptance is a witness. Undecided boxes are halved down to `depth`.
bool reachable(const candidate& c, bool three, const colour& pixel, double threshold, int depth) {
  bool witness = true;
  for (int k = 0; k < channel_count; ++k) {
    const double fine = blend(c.fine, three, k, c.fine.x.middle(), c.fine.y.middle());
    const double coarse = c.two ? blend(c.coarse, three, k, c.coarse.x.middle(), c.coarse.y.middle()) : fine;
    const double f = c.two ? c.level.middle() : 0;
    const double value = (1 - f) * fine + f * coarse;
    // A three-point blend changes along an axis by at most twice the contrast of its patch.
    const double steep = three ? 2 : 1;
    double reach = steep * contrast(c.fine, k) * (c.fine.x.half() + c.fine.y.half());
    if (c.two) reach += steep * contrast(c.coarse, k) * (c.coarse.x.half() + c.coarse.y.half()) + std::fabs(coarse - fine) * c.level.half();
    const double distance = std::fabs(value - pixel[k]);
    if (distance > threshold + reach) return false;
    witness = witness && distance <= threshold;
  }
  if (witness) return true;
  if (depth == 0) return false;
  candidate a, b;
  halve(c, a, b);
  return reachable(a, three, pixel, threshold, depth - 1) || reachable(b, three, pixel, threshold, depth - 1);
}

struct place { double u, v; };  // exact, texels of level 0

class pixel_verifier {
 public:
  pixel_verifier(const texture_view& t, filter kind, const promised_precision& bits)
      : t_(t),
        kind_(kind),
        epsilon_(std::ldexp(1.0, -bits.subtexel_bits)),
        delta_(std::ldexp(1.0, -bits.level_bits)),
        threshold_(bits.colour_lsb + 1e-9) {}

  bool accepts(place at, double level, const colour& pixel) const {
    if (kind_ == filter::nearest) return nearest(at, pixel);
    const double last = t_.last_level();
    const double low = std::clamp(level - delta_, 0.0, last), high = std::clamp(level + delta_, 0.0, last);
    const auto nearest_level = [](double d) { return std::max(0, int(std::ceil(d + 0.5)) - 1); };
    if (kind_ == filter::mip_bilinear) return any_level(at, nearest_level(low), nearest_level(high), pixel);
    if (!uses_levels(kind_)) return any_level(at, 0, 0, pixel);
    for (int l = int(std::floor(low)); l <= int(std::floor(high)); ++l) {
      const interval f{std::clamp(low - l, 0.0, 1.0), std::clamp(high - l, 0.0, 1.0)};
      if (two_levels(at, std::min(l, t_.last_level()), f, pixel)) return true;
    }
    return false;
  }

  // A row of n samples along (du, dv), trilinear.
  bool accepts_row(place at, double du, double dv, int n, double level, const colour& pixel) const {
    std::array<interval, channel_count> sum{};
    for (int k = 0; k < n; ++k) {
      const double part = (2 * k + 1 - n) / (2.0 * n);
      const auto one = trilinear_range({at.u + du * part, at.v + dv * part}, level);
      for (size_t c = 0; c < sum.size(); ++c) sum[c] = {sum[c].low + one[c].low, sum[c].high + one[c].high};
    }
    for (size_t c = 0; c < sum.size(); ++c)
      if (pixel[c] < sum[c].low / n - threshold_ || pixel[c] > sum[c].high / n + threshold_) return false;
    return true;
  }

 private:
  using ranges = std::array<interval, channel_count>;
  static constexpr ranges nothing() { return {{{256, -1}, {256, -1}, {256, -1}, {256, -1}}}; }
  static void widen(interval& a, double low, double high) { a = {std::min(a.low, low), std::max(a.high, high)}; }

  // Everything that a level may be at a position, channel by channel.
  ranges level_range(place at, int level) const {
    ranges out = nothing();
    each_patch(at, level, [&](const patch& p) {
      for (int c = 0; c < channel_count; ++c) {
        const double middle = blend(p, false, c, p.x.middle(), p.y.middle()), reach = contrast(p, c) * (p.x.half() + p.y.half());
        widen(out[size_t(c)], middle - reach, middle + reach);
      }
      return false;
    });
    return out;
  }
  ranges trilinear_range(place at, double level) const {
    const double last = t_.last_level(), low = std::clamp(level - delta_, 0.0, last), high = std::clamp(level + delta_, 0.0, last);
    ranges out = nothing();
    for (int l = int(std::floor(low)); l <= int(std::floor(high)); ++l) {
      const ranges fine = level_range(at, l), coarse = level_range(at, std::min(l + 1, t_.last_level()));
      for (const double f : {std::clamp(low - l, 0.0, 1.0), std::clamp(high - l, 0.0, 1.0)})
        for (size_t c = 0; c < out.size(); ++c)
          widen(out[c], (1 - f) * fine[c].low + f * coarse[c].low, (1 - f) * fine[c].high + f * coarse[c].high);
    }
    return out;
  }

  bool nearest(place at, const colour& pixel) const {
    for (int y = int(std::floor(at.v - epsilon_)); y <= int(std::floor(at.v + epsilon_)); ++y)
      for (int x = int(std::floor(at.u - epsilon_)); x <= int(std::floor(at.u + epsilon_)); ++x)
        if (texel(0, x, y) == pixel) return true;
    return false;
  }

  colour texel(int level, int x, int y) const { return colour_of(t_.texel(level, t_.wrapped_u(x, level), t_.wrapped_v(y, level))); }

  // Calls use(patch) for each 2x2 that the interval around a position touches.
  template <class Use>
  bool each_patch(place at, int level, Use use) const {
    const double u = at.u * t_.width(level) / t_.width() - 0.5, v = at.v * t_.height(level) / t_.height() - 0.5;
    for (int y = int(std::floor(v - epsilon_)); y <= int(std::floor(v + epsilon_)); ++y)
      for (int x = int(std::floor(u - epsilon_)); x <= int(std::floor(u + epsilon_)); ++x) {
        const auto part = [&](double centre, int k) {
          return interval{std::clamp(centre - epsilon_ - k, 0.0, 1.0), std::clamp(centre + epsilon_ - k, 0.0, 1.0)};
        };
        const patch p{
            {texel(level, x, y), texel(level, x + 1, y), texel(level, x, y + 1), texel(level, x + 1, y + 1)}, part(u, x), part(v, y)};
        if (use(p)) return true;
      }
    return false;
  }

  bool any_level(place at, int first, int last, const colour& pixel) const {
    for (int l = first; l <= last; ++l)
      if (each_patch(at, l, [&](const patch& p) {
            return reachable({p, {}, {0, 0}, false}, uses_three_points(kind_), pixel, threshold_, search_depth);
          }))
        return true;
    return false;
  }

  bool two_levels(place at, int level, interval f, const colour& pixel) const {
    const int coarser = std::min(level + 1, t_.last_level());
    return each_patch(at, level, [&](const patch& a) {
      return each_patch(at, coarser, [&](const patch& b) {
        return reachable({a, b, f, true}, uses_three_points(kind_), pixel, threshold_, search_depth);
      });
    });
  }

  static constexpr int search_depth = 16;
  const texture_view& t_;
  filter kind_;
  double epsilon_, delta_, threshold_;
};

// W^2 J at a point, per half pixel.
struct columns { long double ux, uy, vx, vy; };
columns columns_at(const plane& m, int32_t hx, int32_t hy) {
  const int128 w = m.w_at(hx, hy), u = m.u_at(hx, hy), v = m.v_at(hx, hy);
  const auto term = [&](int64_t a, int128 n, int64_t g) { return static_cast<long double>(a * w - n * g); };
  return {term(m.u.x, u, m.w.x), term(m.u.y, u, m.w.y), term(m.v.x, v, m.w.x), term(m.v.y, v, m.w.y)};
}

// The direction nearest to the major axis and, where it is a close call, the next.
std::array<int, 2> directions_at(const plane& m, int32_t hx, int32_t hy) {
  const columns j = columns_at(m, hx, hy);
  const long double across = j.ux * j.ux + j.vx * j.vx - j.uy * j.uy - j.vy * j.vy, twice = 2 * (j.ux * j.uy + j.vx * j.vy);
  const long double turns = std::atan2(twice, across) / (2 * std::acos(-1.0L)) * direction_count;
  const auto wrapped = [](long double k) { return (int(std::floor(k)) % direction_count + direction_count) % direction_count; };
  return {wrapped(turns + 0.499L), wrapped(turns + 0.501L)};
}

class row_verifier {
 public:
  row_verifier(const plane& map, const texture_view& t, const profile& q, const promised_precision& bits)
      : map_(map), q_(q), delta_(std::ldexp(1.0, -bits.level_bits)), pixel_(t, filter::aniso, bits) {}

  bool accepts(int32_t hx, int32_t hy, const colour& pixel) const {
    const int32_t cx = (hx & ~15) + 8, cy = (hy & ~15) + 8;
    for (const auto& [x, y] : {std::pair{hx, hy}, {cx, cy}})
      if (map_.w_at(x, y) > 0)
        for (const int direction : directions_at(map_, x, y))
          if (accepts_along(hx, hy, direction, pixel)) return true;
    return false;
  }

 private:
  bool accepts_along(int32_t hx, int32_t hy, int direction, const colour& pixel) const {
    const long double w = map_.w_at(hx, hy), scale = w * w / 2;
    const columns j = columns_at(map_, hx, hy);
    const screen_direction d = direction_at(direction);
    const long double c = std::ldexp(static_cast<long double>(d.cos), -direction_bits), s = std::ldexp(static_cast<long double>(d.sin), -direction_bits);
    const auto du = double((c * j.ux + s * j.uy) / scale), dv = double((c * j.vx + s * j.vy) / scale);
    const double length = std::log2(std::hypot(du, dv)), area = double(std::log2(std::fabs(j.ux * j.vy - j.uy * j.vx) / (scale * scale)));
    const double ratio = std::clamp(std::min(2 * length - area, length), 0.0, std::log2(double(q_.max_samples)));
    const double minor = length - ratio, level = double(finer_level(minor, q_.sample_bias)) + q_.level_bias / 16.0;
    const auto count = [&](double r) {
      const double widths = std::exp2(r), near = std::min(widths, 2.0), pitches = near + (widths - near) * std::exp2(-q_.sample_spacing / 16.0);
      return std::clamp(int(std::ceil(pitches - q_.sample_slack / 16.0)), 1, q_.max_samples);
    };
    const place at{double(static_cast<long double>(map_.u_at(hx, hy)) / w), double(static_cast<long double>(map_.v_at(hx, hy)) / w)};
    for (int n = count(ratio - delta_); n <= count(ratio + delta_); ++n)
      if (pixel_.accepts_row(at, du, dv, n, level, pixel)) return true;
    return false;
  }

  const plane& map_;
  const profile& q_;
  double delta_;
  pixel_verifier pixel_;
};

}  // namespace

verdict verify_aniso(const plane& map, const texture_view& texture, const profile& samples, const promised_precision& bits, const rgba8* picture,
                     int width_px, int height_px) {
  const row_verifier verifier(map, texture, samples, bits);
  verdict result;
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      const int32_t hx = 2 * x + 1, hy = 2 * y + 1;
      const int64_t w = map.w_at(hx, hy);
      if (w <= 0 || !in_range(map.u_at(hx, hy), w) || !in_range(map.v_at(hx, hy), w)) continue;
      ++result.pixels;
      if (verifier.accepts(hx, hy, colour_of(picture[y * width_px + x]))) continue;
      if (result.failures++ == 0) { result.first_x = x; result.first_y = y; }
    }
  return result;
}

verdict verify_plane(const plane& map, const texture_view& texture, filter kind, const profile& biases, const promised_precision& bits,
                     const rgba8* picture, int width_px, int height_px) {
  const pixel_verifier verifier(texture, kind, bits);
  verdict result;
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      const int32_t hx = 2 * x + 1, hy = 2 * y + 1;
      const int64_t w = map.w_at(hx, hy), nu = map.u_at(hx, hy), nv = map.v_at(hx, hy);
      if (w <= 0 || !in_range(nu, w) || !in_range(nv, w)) continue;
      ++result.pixels;
      const place at{double(static_cast<long double>(nu) / w), double(static_cast<long double>(nv) / w)};
      const double level = uses_levels(kind) ? double(biased_level(biases, exact_level(map, hx, hy))) : 0;
      if (verifier.accepts(at, level, colour_of(picture[y * width_px + x]))) continue;
      if (result.failures++ == 0) { result.first_x = x; result.first_y = y; }
    }
  return result;
}

}  // namespace spantex::sim
