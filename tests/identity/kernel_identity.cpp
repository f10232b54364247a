// SPDX-License-Identifier: Apache-2.0
// Small pictures by every kernel that this machine has, and by the engine: a line for each kernel and filter (tests/scripts/kernel_identity.py).
#include <hal/direct_engine.hpp>
#include <hal/kernels/rows.hpp>
#include <spantex/spantex.hpp>

#include <cstdio>
#include <cstdlib>
#include <vector>

using namespace spantex;

namespace {

using prof = fixed_profile<profiles::standard>;
constexpr int32_t width = 96, height = 64;
constexpr rectangle all{0, 0, width, height}, part{3, 5, 90, 59};

uint64_t random_state = 7;
uint32_t random_bits() {
  random_state = random_state * 6364136223846793005u + 1442695040888963407u;
  return uint32_t(random_state >> 33);
}

struct map_pixels {
  int32_t width, height;
  std::vector<std::vector<rgba8>> levels;
  map_pixels(int32_t w, int32_t h, bool opaque = false) : width(w), height(h) {
    for (;; w = max_of(1, w / 2), h = max_of(1, h / 2)) {
      std::vector<rgba8> level(size_t(w) * size_t(h));
      for (rgba8& t : level) t = {uint8_t(random_bits()), uint8_t(random_bits()), uint8_t(random_bits()), opaque ? uint8_t(255) : uint8_t(random_bits())};
      levels.push_back(level);
      if (w == 1 && h == 1) return;
    }
  }
  texture_view view(wrap u, wrap v, colour_space colours = colour_space::coded) const {
    std::vector<const rgba8*> first;
    for (const auto& level : levels) first.push_back(level.data());
    texture_view t;
    if (texture_view::make(first.data(), int(first.size()), width, height, u, v, t) != status::ok) std::abort();
    t.set_colours(colours);
    return t;
  }
};

// From -size to size.
wide some(int64_t size) { return wide(int64_t(random_bits()) * (size >> 10) / (int64_t(1) << 20) - size); }

// From magnified to minified, flat to steep: affine spans, every length of series, and the divide.
plane plane_of(int k) {
  const int64_t one = int64_t(1) << 30, scale = one >> (k % 3), steep = (one / 64) * (k / 3) / 4;
  plane p;
  const homography m{wide(2 * scale), some(scale), some(100 * one), some(scale), wide(3 * scale), some(100 * one), some(steep / 4), wide(steep / 2), wide(one)};
  if (make_plane(m, all, p) != status::ok) std::abort();
  return p;
}

// Scaled along its axes, magnified to minified.
plane scaled_plane_of(int k) {
  const int64_t one = int64_t(1) << 30;
  const wide none(0);
  plane p;
  if (make_plane({some(one << (k % 4)), none, some(100 * one), none, some(one << (k % 3)), some(100 * one), none, none, wide(one)}, all, p) != status::ok) std::abort();
  return p;
}

struct tally { uint64_t pictures = 0, different = 0, spans = 0, left = 0; };

// Every write-out in turn, every other of the pictures in a colour, over what lies there.
void compare(kernels::choice which, const plane& p, const texture_view& view, filter kind, rectangle area, tally& sum) {
  std::vector<rgba8> expected(size_t(width * height), rgba8{9, 70, 200, 130}), found(expected);
  const shading how{alpha_mode(sum.pictures / 2 % 4), 100, sum.pictures % 2 == 0 ? white : rgba8{250, 128, 3, 240}, nullptr};
  const frame_buffer frame{expected.data(), width, height, width}, other{found.data(), width, height, width};
  static direct_engine<prof> engine;
  renderer<direct_engine<prof>, prof, shading> scalar(engine, prof{}, frame), rest(engine, prof{}, other);
  if (scalar.draw(p, view, kind, area, how) != status::ok || scalar.finish() != status::ok) std::abort();
  draw_counters counts;
  const kernels::planar_map texels(view, kernels::layout_of(which));
  if (kernels::draw_plane(kernels::kernel_of(which), texels, rest, p, view, kind, area, other, counts, how) != status::ok) std::abort();
  const uint64_t spans = (width / span_side) * (height / span_side);  // either area meets all of them
  ++sum.pictures;
  sum.different += !(expected == found);
  sum.spans += spans;
  sum.left += spans - counts.jobs;
}

// Masks and depths by vectors as by the engine.
void compare_masks(kernels::choice which) {
  static std::vector<uint32_t> values(size_t(width * height)), floors(size_t(width * height / 64)), engine_values(values);
  constexpr int32_t one = 1 << 16;
  for (int n = 0; n < 400; ++n) {
    if (n % 20 == 0) {
      values.assign(values.size(), 0);
      floors.assign(floors.size(), 0);
      engine_values = values;
    }
    const auto between = [](int32_t low, int32_t high) { return low + int32_t(random_bits() % uint32_t(high - low)); };
    vertex corners[3];
    const int32_t far = between(one, 20 * one);
    for (vertex& v : corners) {
      const int32_t x = between(-far, far), y = between(-far, far);
      v = {x, y, far + between(-far / 2, far / 2), 0, 0};
    }
    polygon p{};
    if (make_polygon(corners, 3, {width * one, width * one, width * one / 2, height * one / 2, one / 16}, {0, 0, width, height}, p) != status::ok) continue;
    const kernels::masked_polygon masked(p, p.box, {values.data(), floors.data()}, width, height, true);
    for (int32_t sy = p.box.y0 / span_side; sy <= (p.box.y1 - 1) / span_side; ++sy) {
      kernels::row_masks row;
      draw_counters counts;
      kernels::cover_of(which)(masked, sy, nullptr, row, counts);
      for (int k = 0; k < masked.span_count(); ++k) {
        const int32_t sx = masked.first_span() + k;
        const span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy) & front_mask(p.map, sx, sy);
        if (row.mask[k] != (mask == 0 ? 0 : depth_test(p, sx, sy, mask, {engine_values.data()}, width, true))) std::abort();
      }
    }
    if (values != engine_values) std::abort();
  }
}

}  // namespace

int main() {
  const map_pixels maps[] = {{64, 64}, {128, 8}, {48, 80}}, opaque(256, 32, true);
  struct { kernels::choice which; const char* name; } const every[] = {{kernels::choice::pixels, "pixels"}, {kernels::choice::words, "words"}, {kernels::choice::sse41, "sse41"}, {kernels::choice::avx2, "avx2"},
                                                                       {kernels::choice::neon, "neon"}, {kernels::choice::avx512, "avx512"}, {kernels::choice::avx512_gathers, "avx512-gathers"}};
  struct { filter kind; const char* name; } const filters[] = {{filter::nearest, "nearest"}, {filter::bilinear, "bilinear"}, {filter::mip_bilinear, "mip-bilinear"},
                                                               {filter::trilinear, "trilinear"}, {filter::aniso, "aniso"}};
  for (const auto& kernel : every) {
    if (kernels::kernel_of(kernel.which) == nullptr) continue;
    compare_masks(kernel.which);
    for (const auto& f : filters) {
      tally sum;
      random_state = 7;
      for (int k = 0; k < 27; ++k) {
        const plane p = k < 15 ? plane_of(k) : scaled_plane_of(k);
        for (const wrap w : {wrap::repeat, wrap::clamp, wrap::mirror}) compare(kernel.which, p, maps[k % 3].view(w, wrap((int(w) + k) % 3)), f.kind, all, sum);
        compare(kernel.which, p, maps[(k + 1) % 3].view(wrap(k % 3), wrap::repeat, colour_space::srgb), f.kind, k % 2 == 0 ? all : part, sum);
        for (const wrap w : {wrap::repeat, wrap::mirror}) compare(kernel.which, p, opaque.view(w, wrap::repeat), f.kind, part, sum);
      }
      std::printf("%s %s: %d pictures, %d differ; %d of %d spans left\n", kernel.name, f.name, int(sum.pictures), int(sum.different), int(sum.left), int(sum.spans));
    }
  }
}
