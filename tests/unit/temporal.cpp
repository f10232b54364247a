// SPDX-License-Identifier: Apache-2.0
// A slowly moving camera: 128 frames each of a pan, a zoom and an approach in sub-pixel steps, trilinear, with a pattern, a photographic
// map and, where python3-skimage is installed, its bricks.
//
// What is measured. The reference picture is made by exact arithmetic alone (128-bit integers; a long double logarithm): Nu/W and the level
// of detail exactly, each rounded once to 8 bits, exact filtering, rounded once to 8 bits of colour. So the reference is what the best
// possible engine of these word lengths would draw. From one frame to the next
//   swim    is the distance of the engine's position from Nu/W; it must stay within the coordinate bound;
//   excess  is by how much more a channel of a pixel changes in the engine's picture than in the reference.
// Both apart for pixels at a span's border and inside spans: a level or a position that jumped between spans would show at borders.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <sim/image.hpp>
#include <sim/map.hpp>
#include <tests/properties.hpp>  // last: cmocka.h defines fail as a macro

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 96, height = 64;
constexpr rectangle area{0, 0, width, height};
constexpr int frame_count = 128;

enum class motion { pan, zoom, approach };
constexpr motion motions[] = {motion::pan, motion::zoom, motion::approach};
constexpr const char* motion_names[] = {"pan", "zoom", "approach"};

// Frame k of a motion over the tilted sample plane, in 2^-48.
homography frame_of(motion how, int k) {
  homography m = shrunk(sample_homography(1), 5);
  const auto sixteenths = [&](wide c, int64_t n) { return shift_right_floor(multiply(c, n), 4); };
  switch (how) {
    case motion::pan:  // 1/16 pixel a frame to the right, 1/32 down
      m.c = m.c + sixteenths(m.a, k) + sixteenths(m.b, k / 2);
      m.f = m.f + sixteenths(m.d, k) + sixteenths(m.e, k / 2);
      m.i = m.i + sixteenths(m.g, k) + sixteenths(m.h, k / 2);
      break;
    case motion::zoom:  // 1/512 a frame
      for (wide* c : {&m.a, &m.b, &m.d, &m.e, &m.g, &m.h}) *c = *c - shift_right_floor(multiply(*c, k), 9);
      break;
    case motion::approach:  // nearer to the plane: u and v shrink about their origin, level by level
      for (wide* c : {&m.a, &m.b, &m.c, &m.d, &m.e, &m.f}) *c = *c - shift_right_floor(multiply(*c, k), 8);
      break;
  }
  return m;
}

// At most 2.5 units a texel of level 0: a jump of level or position would stand out.
const synthetic_map& soft_map() {
  static const synthetic_map& map = make_map(256, 256, [](int32_t x, int32_t y) {
    const auto wave = [](double t) { return uint8_t(127.5 + 100 * std::sin(t)); };
    constexpr double turn = 2 * 3.14159265358979323846 / 256;
    return rgba8{wave(turn * x), wave(turn * y), wave(turn * (x + y)), 255};
  });
  return map;
}

const texture_map* bricks() {
  static const texture_map* const map = []() -> const texture_map* {
    for (const char* place : {"/usr/lib/python3/dist-packages/skimage/data/brick.png", "/usr/share/python3-skimage/data/brick.png"})
      if (std::filesystem::exists(place)) return new texture_map(load_image(place), prefilter::box, wrap::repeat, wrap::repeat);
    return nullptr;
  }();
  return map;
}

struct frame_state {
  uint8_t drawn[height][width][3], reference[height][width][3];
  bool other_step[height][width];  // a position or level on the other side of a rounding's tie than the reference's
};
frame_state before, now;
picture shown;

// One kind of pixels of one motion.
struct measured {
  double swim_share = 0;  // of the coordinate bound, at most
  int excess = 0;         // at most; unexplained where it is more than a unit for each of the two frames with another step than the reference
  int64_t changes = 0, above_one = 0, unexplained = 0, differing = 0, other_steps = 0, swims = 0;
  double swim_sum = 0;
  double per_million(int64_t n) const { return 1e6 * double(n) / double(changes); }
};
struct measures {
  measured at[2];  // inside spans, at their borders
  measured& border() { return at[1]; }
  measured& inside() { return at[0]; }
};

bool is_at_border(int32_t x, int32_t y) { return x % 8 == 0 || x % 8 == 7 || y % 8 == 0 || y % 8 == 7; }

bool same_position(const snapped_position& a, const snapped_position& b) {
  return a.u == b.u && a.v == b.v && a.fraction.u == b.fraction.u && a.fraction.v == b.fraction.v;
}

template <class Prof>
void take_frame(const Prof& prof, const plane& p, const texture_view& t, measures& m) {
  const profile& q = prof.get();
  shown.reset(width, height);
  SPANTEX_ASSERT_OK(render_plane_direct<Prof::max_fine_side>(prof, p, t, filter::trilinear, shown));
  each_source(prof, {&p, &t, filter::trilinear}, area, [&](int32_t x, int32_t y, const pixel_source& s) {
    measured& out = m.at[is_at_border(x, y)];
    const int32_t hx = 2 * x + 1, hy = 2 * y + 1;
    const int64_t w = p.w_at(hx, hy);
    const double bound = double(coordinate_bound(q, s.extent_log2)) / double(error_unit);
    const double swim =
        std::max(coordinate_error(s.at.u.raw(), p.u_at(hx, hy), w), coordinate_error(s.at.v.raw(), p.v_at(hx, hy), w)) / bound;
    out.swim_share = std::max(out.swim_share, swim);
    out.swim_sum += swim;
    ++out.swims;
    const pixel_source exact = exact_source(p, t, q, x, y);
    now.other_step[y][x] = s.detail != exact.detail || !same_position(s.fine, exact.fine) || !same_position(s.coarse, exact.coarse);
    out.other_steps += now.other_step[y][x];
    const shares mix = shares_of(exact, t, filter::trilinear, q.subtexel_bits, q.level_bits);
    for (int c = 0; c < 3; ++c) {
      now.drawn[y][x][c] = uint8_t(channel_of(shown.pixels[size_t(y * width + x)], c));
      now.reference[y][x][c] = mix.rounded(c);
      out.differing += now.drawn[y][x][c] != now.reference[y][x][c];
    }
  });
}

void compare_frames(measures& m) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      measured& out = m.at[is_at_border(x, y)];
      for (int c = 0; c < 3; ++c) {
        const int excess =
            std::abs(now.drawn[y][x][c] - before.drawn[y][x][c]) - std::abs(now.reference[y][x][c] - before.reference[y][x][c]);
        out.excess = std::max(out.excess, excess);
        out.above_one += excess > 1;
        out.unexplained += excess > now.other_step[y][x] + before.other_step[y][x];
        ++out.changes;
      }
    }
}

template <class Prof>
measures measure(const Prof& prof, const char* name, motion how, const texture_view& t) {
  measures m;
  for (int k = 0; k < frame_count; ++k) {
    take_frame(prof, plane_of(frame_of(how, k), width, height), t, m);
    if (k > 0) compare_frames(m);
    before = now;
  }
  for (int k : {1, 0}) {
    const measured& o = m.at[k];
    std::printf(
        "# %s, %s, %s: swim %.3f of the bound (mean %.4f), excess %d, above 1: %.2f ppm; %.0f ppm of colours and %.2f %% of steps are not "
        "the reference's\n",
        name, motion_names[int(how)], k == 1 ? "borders" : "inside ", o.swim_share, o.swim_sum / double(o.swims), o.excess,
        o.per_million(o.above_one), o.per_million(o.differing), 100.0 * double(o.other_steps) / double(o.swims));
  }
  return m;
}

// A jump between spans would make borders stand out: here they may not differ more often than the inside does, but for chance.
void assert_borders_are_no_worse(measures& m) {
  const auto rate = [](int64_t n, int64_t of) { return double(n) / double(of); };
  const measured &b = m.border(), &i = m.inside();
  assert_true(b.swim_sum / double(b.swims) <= 1.1 * i.swim_sum / double(i.swims));
  assert_true(rate(b.other_steps, b.swims) <= 1.1 * rate(i.other_steps, i.swims));
  assert_true(rate(b.differing, b.changes) <= 1.25 * rate(i.differing, i.changes));
}

void moves_without_swimming_or_popping(const char* name, const texture_view& t, int limit) {
  for (const motion how : motions) {
    measures m = measure(fixed_profile<profiles::exact>{}, name, how, t);
    for (const measured& o : m.at) {
      assert_true(o.swim_share <= 1);
      assert_true(o.differing > 0);  // the measure sees single steps at all
      assert_true(o.excess <= limit && o.per_million(o.above_one) <= 1);
      assert_int_equal(o.unexplained, 0);  // nothing pops but ties of rounding, a unit each
    }
    assert_borders_are_no_worse(m);
  }
}

}  // namespace

SPANTEX_CASE(exact_with_a_pattern) { moves_without_swimming_or_popping("exact, pattern", soft_map().view(wrap::repeat, wrap::repeat), 1); }
SPANTEX_CASE(exact_with_bricks) {
  if (bricks() == nullptr) skip();
  moves_without_swimming_or_popping("exact, bricks", bricks()->view(), 1);
}
// Its neighbouring texels may differ by all of 255, so that one step of a weight is a whole unit: a pixel whose position or level lies on a
// tie in either frame may be a unit off in each, in opposite directions. That is 2, at one colour in a million at most, wherever the tie lies.
SPANTEX_CASE(exact_with_a_harsh_map) {
  moves_without_swimming_or_popping("exact, harsh", photographic_map(256, 256, 9).view(wrap::repeat, wrap::repeat), 2);
}

namespace {
constexpr profile one_level_a_span = [] {
  profile p = profiles::seed;
  p.overflow = overflow_policy::split;
  return p;
}();
}  // namespace

// The measure sees spans where there are any: one integer level and a clamped section a span, against KT88's formula evaluated exactly. The
// level alone (its sections split instead of clamped) does far less. docs/ACCURACY.md quotes this.
SPANTEX_CASE(seed_pops_at_span_borders) {
  const texture_view t = soft_map().view(wrap::repeat, wrap::repeat);
  for (const motion how : motions) {
    measures level = measure(fixed_profile<one_level_a_span>{}, "seed without clamp, pattern", how, t);
    measures m = measure(fixed_profile<profiles::seed>{}, "seed, pattern", how, t);
    assert_true(level.border().per_million(level.border().above_one) < 0.1 * m.border().per_million(m.border().above_one));
    assert_true(m.border().per_million(m.border().above_one) > 1.5 * m.inside().per_million(m.inside().above_one));
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(exact_with_a_pattern),
      cmocka_unit_test(exact_with_bricks),
      cmocka_unit_test(exact_with_a_harsh_map),
      cmocka_unit_test(seed_pops_at_span_borders),
  };
  return run_suite("temporal", tests);
}
