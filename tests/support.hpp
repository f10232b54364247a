// SPDX-License-Identifier: Apache-2.0
// What the unit tests share: CMocka with a filter, a trap for allocations, random numbers, synthetic maps, planes, and rendering
// into a picture. A unit test is one source file that includes this header once; it defines what the linker's --wrap asks for.
//
// A failing assertion leaves a test by longjmp: keep locals trivially destructible, and pictures and maps `static`.
#pragma once
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <csetjmp>
extern "C" {
#include <cmocka.h>
}

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <new>
#include <vector>

#include <hal/direct_engine.hpp>
#include <spantex/spantex.hpp>

#define SPANTEX_CASE(name) static void name(void**)
#define SPANTEX_ASSERT_OK(expression) assert_int_equal(int(expression), int(::spantex::status::ok))
#define SPANTEX_ASSERT_STATUS(expression, code) assert_int_equal(int(expression), int(::spantex::status::code))

// --- allocations ---------------------------------------------------------------------------------------

namespace spantex::sim {

// Counts what malloc, calloc, realloc and operator new are asked for while a zone is open. Atomic: compilers take it that malloc touches
// no variable of ours, and would otherwise drop the stores around it.
struct allocation_trap {
  static inline std::atomic<bool> open{false};
  static inline std::atomic<uint64_t> count{0};
  static void begin() { count = 0; open = true; }
  static uint64_t end() { open = false; return count; }
  static void note() { if (open) ++count; }
};

}  // namespace spantex::sim

extern "C" {
void* __real_malloc(size_t);
void* __real_calloc(size_t, size_t);
void* __real_realloc(void*, size_t);
void* __wrap_malloc(size_t);
void* __wrap_calloc(size_t, size_t);
void* __wrap_realloc(void*, size_t);
void* __wrap_malloc(size_t size) { spantex::sim::allocation_trap::note(); return __real_malloc(size); }
void* __wrap_calloc(size_t count, size_t size) { spantex::sim::allocation_trap::note(); return __real_calloc(count, size); }
void* __wrap_realloc(void* p, size_t size) { spantex::sim::allocation_trap::note(); return __real_realloc(p, size); }
}

[[gnu::noinline]] void* operator new(size_t size) {
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, size_t) noexcept { std::free(p); }

namespace spantex::sim {

// Exact arithmetic of the tests themselves.
__extension__ typedef __int128 int128;
__extension__ typedef unsigned __int128 uint128;

constexpr int128 magnitude_of(int128 x) { return x < 0 ? -x : x; }
constexpr int128 to_int128(wide a) { return int128(uint128(uint64_t(a.high)) << 64 | a.low); }
constexpr wide to_wide(int128 x) { return {int64_t(x >> 64), uint64_t(x)}; }

// Slow builds (sanitizers) take every so-manyth of an exhaustive range.
inline bool short_run() { return std::getenv("SPANTEX_SHORT") != nullptr; }

// Runs a suite; SPANTEX_TEST_FILTER (with * and ?) selects cases.
template <size_t N>
int run_suite(const char* name, const CMUnitTest (&tests)[N]) {
  if (const char* wanted = std::getenv("SPANTEX_TEST_FILTER")) cmocka_set_test_filter(wanted);
  return cmocka_run_group_tests_name(name, tests, nullptr, nullptr);
}

// --- random numbers ------------------------------------------------------------------------------------

// splitmix64 (Steele, Lea, Flood 2014): the same numbers on every machine.
struct random_source {
  uint64_t state;
  constexpr explicit random_source(uint64_t seed) : state(seed) {}
  SPANTEX_WRAPS constexpr uint64_t next() {
    uint64_t z = state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  // Uniform in [low, high].
  SPANTEX_WRAPS constexpr int64_t between(int64_t low, int64_t high) {
    const uint64_t span = uint64_t(high) - uint64_t(low) + 1;
    return int64_t(uint64_t(low) + (span == 0 ? next() : next() % span));
  }
  // Every magnitude alike: a random number of bits up to `bits`, any sign.
  SPANTEX_WRAPS constexpr int64_t any_magnitude(int bits) {
    const int kept = int(next() % uint64_t(bits + 1));
    const uint64_t m = kept == 0 ? 0 : next() >> (64 - kept);
    return (next() & 1) != 0 ? -int64_t(m) : int64_t(m);
  }
};

// --- maps ----------------------------------------------------------------------------------------------

struct level_pixels {
  int32_t width, height;
  std::vector<rgba8> texels;
  const rgba8& at(int32_t x, int32_t y) const { return texels[size_t(y) * size_t(width) + size_t(x)]; }
};

namespace detail {

// Lattice noise in [0, 255]: a hash of the cell.
inline int32_t lattice(int32_t x, int32_t y, uint32_t seed) {
  random_source r((uint64_t(uint32_t(x)) << 32 | uint32_t(y)) ^ (uint64_t(seed) << 17));
  return int32_t(r.next() >> 56);
}

// Bilinear lattice noise at (x, y) for cells of 2^log2 texels.
inline int32_t smooth_noise(int32_t x, int32_t y, int log2, uint32_t seed) {
  const int32_t side = 1 << log2, cx = x >> log2, cy = y >> log2, fx = x & (side - 1), fy = y & (side - 1);
  const int32_t top = lattice(cx, cy, seed) * (side - fx) + lattice(cx + 1, cy, seed) * fx;
  const int32_t bottom = lattice(cx, cy + 1, seed) * (side - fx) + lattice(cx + 1, cy + 1, seed) * fx;
  return (top * (side - fy) + bottom * fy) >> (2 * log2);
}

// Like a photograph: large soft areas, fine grain, a few sharp lines; each channel its own.
inline uint8_t photographic_channel(int32_t x, int32_t y, uint32_t seed) {
  int32_t sum = 0;
  for (int log2 = 5; log2 >= 0; --log2) sum += smooth_noise(x, y, log2, seed + uint32_t(log2)) * (1 << log2);
  const int32_t soft = sum / 63;
  const bool line = x % 24 == 3 || y % 17 == 5;
  return uint8_t(line ? 255 - soft : soft);
}

inline level_pixels halved(const level_pixels& fine) {
  level_pixels out{max_of(1, fine.width / 2), max_of(1, fine.height / 2), {}};
  for (int32_t y = 0; y < out.height; ++y)
    for (int32_t x = 0; x < out.width; ++x) {
      const int32_t x0 = min_of(2 * x, fine.width - 1), x1 = min_of(2 * x + 1, fine.width - 1);
      const int32_t y0 = min_of(2 * y, fine.height - 1), y1 = min_of(2 * y + 1, fine.height - 1);
      const rgba8 &a = fine.at(x0, y0), &b = fine.at(x1, y0), &c = fine.at(x0, y1), &d = fine.at(x1, y1);
      const auto mean = [&](uint8_t rgba8::*m) { return uint8_t((a.*m + b.*m + c.*m + d.*m + 2) / 4); };
      out.texels.push_back({mean(&rgba8::r), mean(&rgba8::g), mean(&rgba8::b), mean(&rgba8::a)});
    }
  return out;
}

}  // namespace detail

// A map with all its levels (2x2 box). Lives until the program ends.
struct synthetic_map {
  std::vector<level_pixels> levels;
  texture_view view(wrap wrap_u, wrap wrap_v) const {
    const rgba8* pointers[max_levels] = {};
    for (size_t k = 0; k < levels.size(); ++k) pointers[k] = levels[k].texels.data();
    texture_view t;
    if (texture_view::make(pointers, int(levels.size()), levels[0].width, levels[0].height, wrap_u, wrap_v, t) != status::ok) std::abort();
    return t;
  }
};

template <class Texel>
const synthetic_map& make_map(int32_t width, int32_t height, Texel texel) {
  static std::deque<synthetic_map> kept;
  level_pixels base{width, height, {}};
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) base.texels.push_back(texel(x, y));
  synthetic_map m;
  m.levels.push_back(base);
  while (m.levels.back().width > 1 || m.levels.back().height > 1) m.levels.push_back(detail::halved(m.levels.back()));
  kept.push_back(m);
  return kept.back();
}

inline const synthetic_map& photographic_map(int32_t width, int32_t height, uint32_t seed = 1) {
  return make_map(width, height, [seed](int32_t x, int32_t y) {
    const auto channel = [&](uint32_t k) { return detail::photographic_channel(x, y, seed * 64 + k * 8); };
    return rgba8{channel(0), channel(1), channel(2), channel(3)};
  });
}

inline const synthetic_map& constant_map(int32_t width, int32_t height, rgba8 colour) {
  return make_map(width, height, [colour](int32_t, int32_t) { return colour; });
}

// --- planes --------------------------------------------------------------------------------------------

// Coefficients of u = (a x + b y + c)/(g x + h y + i), v = (d x + e y + f)/(...) to 2^-48.
inline homography homography_of(const double (&m)[9]) {
  const auto w = [&](int k) { return wide(int64_t(m[k] * 281474976710656.0)); };
  return {w(0), w(1), w(2), w(3), w(4), w(5), w(6), w(7), w(8)};
}

// Seen at 640 x 480 (a 512-texel map): facing, tilted, grazing, and one whose horizon crosses the picture.
inline constexpr int sample_plane_count = 4;
inline homography sample_homography(int k) {
  static constexpr double planes[sample_plane_count][9] = {
      {0.912053716, -0.314742496, -140.780791, -0.331960405, -0.8647479, 521.306321, 0, 0.000288959809, 0.896575472},
      {0.621854806, -0.142806403, -12.2821072, -0.226336639, -0.392357368, 585.413164, 0, 0.000855254125, 0.43752662},
      {0.310927403, -0.0343267394, 3.36869896, -0.11316832, -0.0943119413, 318.834413, 0, 0.00106181177, 0.0541821689},
      {0.21, -0.05, -31.7, -0.08, 0.13, 103.9, 0.0002, 0.0011, -0.171}};
  return homography_of(planes[k]);
}

inline plane sample_plane(int k, rectangle region = {0, 0, 640, 480}) {
  plane p{};
  if (make_plane(sample_homography(k), region, p) != status::ok) std::abort();
  return p;
}

// A random plane over a region: u, v of any size up to 2^15, slopes from 2^-13 to 2^7 texels a pixel, W from constant to a horizon
// across the region. False if set-up refuses it.
inline bool random_plane(random_source& random, rectangle region, plane& out) {
  const auto number = [&](int low_log2, int high_log2) {  // 40 fraction bits, log-uniform
    const int e = int(random.between(low_log2, high_log2)) + 40;
    const int64_t m = int64_t((random.next() >> 11) | (uint64_t(1) << 52));
    const int64_t x = e >= 52 ? m << (e - 52) : m >> (52 - e);
    return (random.next() & 1) != 0 ? -x : x;
  };
  const int32_t x = int32_t(random.between(region.x0, region.x1 - 1)), y = int32_t(random.between(region.y0, region.y1 - 1));
  const int size_log2 = bit_length(uint64_t(max_of(region.x1 - region.x0, region.y1 - region.y0)));
  const int64_t one = int64_t(1) << 40;
  int64_t g = 0, h = 0;
  const uint64_t kind = random.next() % 8;
  if (kind != 0) g = number(-24, 1 - size_log2);
  if (kind > 1) h = number(-24, 1 - size_log2);
  // W = 1 at (x, y); u = u0 and v = v0 there.
  const int64_t a = number(-13, 7), b = number(-13, 7), d = number(-13, 7), e = number(-13, 7);
  const int64_t u0 = kind == 7 ? number(14, 14) : number(-4, 14), v0 = number(-4, 14);
  const auto at_point = [&](int64_t value, int64_t sx, int64_t sy) { return wide(value) - multiply(wide(sx), x) - multiply(wide(sy), y); };
  const homography m{wide(a), wide(b), at_point(u0, a, b), wide(d), wide(e), at_point(v0, d, e),
                     wide(g), wide(h), at_point(one, g, h)};
  return make_plane(m, region, out) == status::ok;
}

// A view whose texels nobody reads: for planning only.
inline texture_view unread_view(int32_t width, int32_t height, wrap wrap_u = wrap::repeat, wrap wrap_v = wrap::repeat) {
  static const rgba8 texel{};
  const rgba8* pointers[max_levels];
  for (const rgba8*& p : pointers) p = &texel;
  texture_view t;
  const int levels = bit_length(uint64_t(max_of(width, height)));
  if (texture_view::make(pointers, levels, width, height, wrap_u, wrap_v, t) != status::ok) std::abort();
  return t;
}

// --- pictures ------------------------------------------------------------------------------------------

inline constexpr rgba8 background{17, 34, 51, 68};

// Declare static in tests.
struct picture {
  int32_t width = 0, height = 0;
  std::vector<rgba8> pixels;
  void reset(int32_t w, int32_t h) {
    width = w;
    height = h;
    pixels.assign(size_t(w) * size_t(h), background);
  }
  frame_buffer frame() { return {pixels.data(), width, height, width}; }
  rectangle area() const { return {0, 0, width, height}; }
  bool operator==(const picture&) const = default;
};

// FNV-1a over the bytes.
inline uint64_t hash_of(const picture& p) {
  uint64_t h = 0xCBF29CE484222325u;
  const auto mix = [&h](uint8_t byte) SPANTEX_WRAPS { h = (h ^ byte) * 0x100000001B3u; };
  for (const rgba8& c : p.pixels) { mix(c.r); mix(c.g); mix(c.b); mix(c.a); }
  return h;
}

inline int64_t differing_pixels(const picture& a, const picture& b) {
  int64_t n = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) n += a.pixels[k] == b.pixels[k] ? 0 : 1;
  return n;
}

// Draws a plane over the whole picture, which must have its size already.
template <class Prof, span_engine Engine>
status render_plane(const Prof& prof, Engine& engine, const plane& p, const texture_view& t, filter kind, picture& out) {
  renderer<Engine, Prof> r(engine, prof, out.frame());
  SPANTEX_TRY(r.draw(p, t, kind, out.area()));
  return r.finish();
}

// The same with a fresh direct engine with local memory of Side x Side texels.
template <int Side, class Prof>
status render_plane_direct(const Prof& prof, const plane& p, const texture_view& t, filter kind, picture& out) {
  direct_engine<Prof, Side> engine(prof);
  return render_plane(prof, engine, p, t, kind, out);
}

inline constexpr filter one_sample_filters[] = {filter::nearest,      filter::bilinear,  filter::three_point,
                                                filter::mip_bilinear, filter::trilinear, filter::trilinear3};
inline constexpr filter all_filters[] = {filter::nearest,   filter::bilinear,   filter::three_point, filter::mip_bilinear,
                                         filter::trilinear, filter::trilinear3, filter::squares,     filter::aniso,
                                         filter::contour,   filter::step,       filter::hat};
inline constexpr wrap all_wraps[] = {wrap::repeat, wrap::clamp, wrap::mirror};

struct named_profile { const char* name; profile value; };
inline constexpr named_profile all_profiles[] = {
    {"seed", profiles::seed}, {"compact", profiles::compact}, {"default", profiles::standard}, {"exact", profiles::exact}};

}  // namespace spantex::sim
