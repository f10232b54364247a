// SPDX-License-Identifier: Apache-2.0
// Kernels alone: random runs of every length, straight and bent, with levels of detail that change and not, against the specification (sample.hpp), and
// what lies beside a run's pixels, then loops inlined beside constants. Prints a line "runs kernel length hash", and "differs" in place of the hash where one is not as specified, and
// ends with 1 then; tools/count_instructions compares the lines with the host's.
#include "random_numbers.hpp"

#include <spantex/rows/kernels.hpp>

#include <firmware/targets/console.hpp>

using namespace spantex;
using app::between, app::random_number;

static constexpr int32_t side = 64, rounds = 60, beside = 9;
static uint16_t fine[side * side], coarse[side * side / 4], pixels[rows::longest_run + 2 * beside];
static rows::scratch scratch;

// Positions along an axis that stay in texels [2, side - 3]: by start, step and bend that are drawn again until they do.
static void make_axis(int count, bool bent, int32_t& x, int32_t& dx, int32_t& ddx) {
  for (;;) {
    x = between(2 << 16, (side - 3) << 16);
    dx = between(-3 << 16, 3 << 16) >> between(0, 18);
    ddx = bent ? between(-1 << 12, 1 << 12) >> between(0, 12) : 0;
    bool within = true;
    for (int32_t k = 0, at = x, step = dx; k < count; ++k, at += step, step += ddx) within = within && at >= 2 << 16 && at < (side - 3) << 16;
    if (within) return;
  }
}

static rows::texels four(const uint16_t* map, int32_t width, int32_t u, int32_t v) {
  const uint16_t* const t = map + (v >> 16) * width + (u >> 16);
  return {t[0], t[1], t[width], t[width + 1]};
}

enum class kernel { nearest, masked, three_point, bilinear, trilinear };

static uint16_t specified(kernel k, const rows::walk& w, int32_t level) {
  const uint32_t fu = rows::weight_of(w.u), fv = rows::weight_of(w.v);
  const rows::texels t = four(fine, side, w.u, w.v);
  if (k == kernel::nearest || k == kernel::masked) return uint16_t(t.t00);
  if (k == kernel::three_point) return rows::rounded(rows::three_point(t, fu, fv), 5);
  if (k == kernel::bilinear) return rows::rounded(rows::four_point(t, fu, fv), 10);
  const int32_t u = (w.u + rows::snap) >> 1, v = (w.v + rows::snap) >> 1;
  const rows::sums far = rows::four_point(four(coarse, side / 2, u, v), rows::weight_of(u), rows::weight_of(v));
  return rows::rounded(rows::between_levels(rows::four_point(t, fu, fv), far, rows::fraction_of(level)), 14);
}

static void draw(kernel k, uint16_t* out, int count, const rows::walk& w, const rows::level_run& level) {
  const rows::source near{fine, 2 * side}, far{coarse, side};
  switch (k) {
    case kernel::nearest: return rows::nearest_run(out, count, w, near);
    case kernel::masked: return rows::nearest_masked_run(out, count, w, near, (side - 1) << 16 | (side - 1));
    case kernel::three_point: return rows::three_point_run(out, count, w, near, scratch);
    case kernel::bilinear: return rows::bilinear_run(out, count, w, near, scratch);
    case kernel::trilinear: return rows::trilinear_run(out, count, w, near, far, level, scratch);
  }
}

// A run; false if it is not as specified.
static bool is_drawn(kernel k, int count, uint32_t& hash) {
  const bool bent = (random_number() & 1) != 0;
  rows::walk w{};
  make_axis(count, bent, w.u, w.du, w.ddu);
  make_axis(count, bent, w.v, w.dv, w.ddv);
  const rows::level_run level{between(0, 0xFFFF), (random_number() & 1) != 0 ? between(-700, 700) : 0};
  for (uint16_t& p : pixels) p = 0xA55A;
  draw(k, pixels + beside, count, w, level);
  bool right = true;
  for (int n = -beside; n < int(rows::longest_run) + beside; ++n) {
    const uint16_t found = pixels[n + beside];
    if (n < 0 || n >= count) {
      right = right && found == 0xA55A;
      continue;
    }
    right = right && found == specified(k, w, level.start + n * level.step);
    w.step();
    hash = (hash ^ found) * 16777619u;
  }
  return right;
}

// Numbers that the compiler knows to be equal, where a loop is inlined: an operand must not share its register with one that is still to be read.
[[gnu::noinline, gnu::flatten]] static void draw_level_run(int count) { rows::nearest_run(pixels, count, {0x8000, 0, 0x8000, 0, 0, 0}, {fine, 2 * side}); }
[[gnu::noinline, gnu::flatten]] static void draw_diagonal(int count, int32_t x) { rows::nearest_run(pixels, count, {x, x, x, x, 0, 0}, {fine, 2 * side}); }
static bool equal_numbers_are_kept_apart() {
  bool right = true;
  draw_level_run(8);
  for (int k = 0; k < 8; ++k) right = right && pixels[k] == fine[(k + 1) / 2];
  draw_diagonal(8, 0x8000);
  for (int k = 0; k < 8; ++k) right = right && pixels[k] == fine[(k + 1) / 2 * (side + 1)];
  console::print(right ? "runs equal numbers right\n" : "runs equal numbers differ\n");
  return right;
}

int main() {
  constexpr uint16_t ends[] = {0, 0xFFFF, 0xF81F, 0x07E0};
  for (uint16_t& t : fine) t = (random_number() & 3) == 0 ? ends[random_number() >> 8 & 3] : uint16_t(random_number() >> 8);
  for (uint16_t& t : coarse) t = (random_number() & 3) == 0 ? ends[random_number() >> 8 & 3] : uint16_t(random_number() >> 8);
  const char* const names[] = {"nearest ", "masked ", "three-point ", "bilinear ", "trilinear "};
  bool all_right = equal_numbers_are_kept_apart();
  for (int k = 0; k < 5; ++k)
    for (int count = 1; count <= int(rows::longest_run); ++count) {
      bool right = true;
      uint32_t hash = 2166136261u;
      for (int32_t n = 0; n < rounds; ++n) right = is_drawn(kernel(k), count, hash) && right;
      all_right = all_right && right;
      console::print("runs ");
      console::print(names[k]);
      console::print_hex(uint32_t(count));
      console::print(" ");
      if (right) console::print_hex(hash);
      else console::print("differs");
      console::print("\n");
    }
  return all_right ? 0 : 1;
}
