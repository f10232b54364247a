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
  if (kernels::draw_plane(kernels::kernel_of(which), texels, rest, p, view, kind, area, other, counts, how) != status::ok || rest.finish() != status::ok) std::abort();
  const uint64_t spans = (width / span_side) * (height / span_side);  // either area meets all of them
  ++sum.pictures;
  sum.different += !(expected == found);
  sum.spans += spans;
  sum.left += spans - counts.jobs;
}

// By vectors as by the engine.
void compare_coverage() {
  for (int n = 0; n < 2000; ++n) {
    edge_set set;
    for (set.count = 0; set.count < 1 + n % 5; ++set.count) {
      const auto point = [] { return screen_point{int32_t(random_bits() % (width << subpixel_bits)), int32_t(random_bits() % (height << subpixel_bits))}; };
      set.edges[set.count] = make_edge(point(), point());
    }
    kernels::polygon_coverage by_vectors(set);
    for (int32_t sy = 0; sy < height / span_side; ++sy) {
      by_vectors.begin_row(sy);
      for (int32_t sx = 0; sx < width / span_side; ++sx)
        if (by_vectors.of(sx) != coverage(set, sx, sy)) std::abort();
    }
  }
}

}  // namespace

int main() {
  const map_pixels maps[] = {{64, 64}, {128, 8}, {48, 80}}, opaque(256, 32, true);
  struct { kernels::choice which; const char* name; } const every[] = {{kernels::choice::words, "words"}, {kernels::choice::sse41, "sse41"}, {kernels::choice::avx2, "avx2"},
                                                                       {kernels::choice::neon, "neon"}, {kernels::choice::avx512, "avx512"}, {kernels::choice::avx512_gathers, "avx512-gathers"}};
  struct { filter kind; const char* name; } const filters[] = {{filter::nearest, "nearest"}, {filter::bilinear, "bilinear"}, {filter::mip_bilinear, "mip-bilinear"},
                                                               {filter::trilinear, "trilinear"}, {filter::aniso, "aniso"}};
  compare_coverage();
  for (const auto& kernel : every) {
    if (kernels::kernel_of(kernel.which) == nullptr) continue;
    for (const auto& f : filters) {
      tally sum;
      random_state = 7;
      for (int k = 0; k < 27; ++k) {
        const plane p = k < 15 ? plane_of(k) : scaled_plane_of(k);
        for (const wrap w : {wrap::repeat, wrap::clamp, wrap::mirror}) compare(kernel.which, p, maps[k % 3].view(w, wrap((int(w) + k) % 3)), f.kind, all, sum);
        compare(kernel.which, p, maps[(k + 1) % 3].view(wrap(k % 3), wrap::repeat, colour_space::srgb), f.kind, k % 2 == 0 ? all : part, sum);
        for (const wrap w : {wrap::repeat, wrap::mirror}) compare(kernel.which, p, opaque.view(w, wrap::repeat), f.kind, part, sum);
      }
      std::printf("%s %s: %d pictures, %d differ; %d of %d spans left to the engine\n", kernel.name, f.name, int(sum.pictures), int(sum.different), int(sum.left), int(sum.spans));
    }
  }
}
