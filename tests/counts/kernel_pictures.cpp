// SPDX-License-Identifier: Apache-2.0
// Parts of pictures by one of the host kernels, for tests/scripts/kernel_instructions.py, which counts the instructions that `spantex bench` would time: those of
// draw_counted (callgrind) or from count_begin to count_end (QEMU). AVX-512, which neither knows, the program counts itself, by the processor's trap after each
// instruction. Prints a line a picture: its name, and what the trap counted.
//   kernel_pictures KERNEL [--trap] [NAME...]     of all pictures these; exit code 3: this machine has not the kernel
#include <hal/direct_engine.hpp>
#include <hal/kernels/rows.hpp>
#include <sim/planes.hpp>
#include <spantex/spantex.hpp>

#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string>
#include <vector>

namespace {
bool traps = false;
volatile sig_atomic_t instructions = 0;
void count_one(int) { instructions = instructions + 1; }
}  // namespace

extern "C" {
[[gnu::noinline, gnu::used]] void count_begin() {
  asm volatile("");
#if defined(__x86_64__)
  if (traps) asm volatile("sub $128, %%rsp\n pushfq\n orq $0x100, (%%rsp)\n popfq\n add $128, %%rsp" ::: "memory", "cc");
#endif
}
[[gnu::noinline, gnu::used]] void count_end() {
  asm volatile("");
#if defined(__x86_64__)
  if (traps) asm volatile("sub $128, %%rsp\n pushfq\n andq $~0x100, (%%rsp)\n popfq\n add $128, %%rsp" ::: "memory", "cc");
#endif
}
}

using namespace spantex;

namespace {

using prof = fixed_profile<profiles::standard>;
constexpr rectangle screen{0, 0, 640, 480}, drawn{192, 232, 448, 248};
constexpr int map_side = 512;

struct named_plane { const char* name; sim::matrix m; };
// The bench's floor with its horizon at y.
constexpr sim::matrix horizon_at(double y) {
  sim::matrix m = sim::horizon_plane;
  m[8] = -m[7] * y;
  return m;
}
// The bench's, and what has a way of its own: W constant, and no turn besides; a horizon just above what is drawn, of which the upper row is drawn pixel by pixel then.
constexpr named_plane planes[] = {{"facing", sim::facing_plane}, {"tilted", sim::tilted_plane}, {"grazing", sim::grazing_plane}, {"close", sim::close_plane}, {"far", sim::far_plane},
                                  {"turned", {0.8, -0.3, 100, 0.3, 0.8, 20, 0, 0, 1}}, {"scaled", {0.73, 0, 11.3, 0, 0.61, 5.7, 0, 0, 1}},
                                  {"horizon", horizon_at(225.6)}};

struct named_filter { const char* name; filter kind; };
constexpr named_filter filters[] = {{"nearest", filter::nearest}, {"bilinear", filter::bilinear}, {"mip-bilinear", filter::mip_bilinear}, {"trilinear", filter::trilinear}, {"aniso", filter::aniso}};

struct named_kernel { const char* name; kernels::choice which; };
constexpr named_kernel every_kernel[] = {{"words", kernels::choice::words}, {"sse41", kernels::choice::sse41}, {"avx2", kernels::choice::avx2}, {"avx512", kernels::choice::avx512},
                                         {"avx512-gathers", kernels::choice::avx512_gathers}, {"neon", kernels::choice::neon}};

// Every plane by every filter; and of some, what takes another way from texels to the frame: linear light, write-out.
enum class way : uint8_t { stored, srgb, cut_out, blended };
constexpr const char* way_names[] = {"", "-srgb", "-cut-out", "-blended"};
struct picture { named_plane plane; named_filter filter; way how; };
std::string name_of(const picture& p) { return std::string(p.plane.name) + "-" + p.filter.name + way_names[size_t(p.how)]; }

std::vector<picture> every_picture() {
  std::vector<picture> all;
  for (const named_plane& p : planes)
    for (const named_filter& f : filters) all.push_back({p, f, way::stored});
  const auto add = [&](const char* plane, const char* filter, way how) {
    const auto named = [](const auto& list, std::string name) { return *std::find_if(std::begin(list), std::end(list), [&](const auto& one) { return name == one.name; }); };
    all.push_back({named(planes, plane), named(filters, filter), how});
  };
  for (const char* filter : {"bilinear", "trilinear", "aniso"}) add("tilted", filter, way::srgb);
  add("close", "aniso", way::srgb);
  add("tilted", "nearest", way::cut_out);
  add("tilted", "trilinear", way::blended);
  return all;
}

struct noise {
  std::vector<std::vector<rgba8>> levels;
  texture_view view;

  explicit noise(way how = way::stored) {
    uint32_t state = 7;
    std::vector<const rgba8*> first;
    for (int side = map_side; side >= 1; side /= 2) {
      std::vector<rgba8>& level = levels.emplace_back(size_t(side) * size_t(side));
      for (rgba8& t : level) {
        state = state * 1664525u + 1013904223u;
        t = {uint8_t(state >> 24), uint8_t(state >> 16), uint8_t(state >> 8), how < way::cut_out ? uint8_t(255) : uint8_t(state >> 20)};
      }
    }
    for (const std::vector<rgba8>& level : levels) first.push_back(level.data());
    if (texture_view::make(first.data(), int(first.size()), map_side, map_side, wrap::repeat, wrap::repeat, view) != status::ok) std::abort();
    if (how == way::srgb) view.set_colours(colour_space::srgb);
  }
};

struct ready_map {
  noise map;
  kernels::planar_map texels;
  ready_map(way how, kernels::layout of) : map(how), texels(map.view, of) {}
};

plane made(const named_plane& named) {
  plane p;
  if (make_plane(sim::to_homography(named.m), screen, p) != status::ok) std::abort();
  return p;
}

template <class Renderer>
[[gnu::noinline]] uint64_t draw_counted(kernels::row_kernel kernel, const ready_map& from, const plane& p, filter kind, const frame_buffer& frame, const typename Renderer::shading_type& how) {
  count_begin();
  direct_engine<prof> engine;
  Renderer rest(engine, prof{}, frame);
  draw_counters counts;
  const status done = kernels::draw_plane(kernel, from.texels, rest, p, from.map.view, kind, drawn, frame, counts, how);
  count_end();
  if (done != status::ok) std::abort();
  return counts.jobs;
}

uint64_t draw(kernels::row_kernel kernel, const ready_map& from, const picture& what, const frame_buffer& frame) {
  const plane p = made(what.plane);
  if (what.how < way::cut_out) return draw_counted<renderer<direct_engine<prof>, prof>>(kernel, from, p, what.filter.kind, frame, {});
  const shading how{what.how == way::cut_out ? alpha_mode::cut_out : alpha_mode::blended, 128, white, nullptr};
  return draw_counted<renderer<direct_engine<prof>, prof, shading>>(kernel, from, p, what.filter.kind, frame, how);
}

}  // namespace

int main(int argc, char** argv) {
  const named_kernel* k = argc < 2 ? std::end(every_kernel) : std::find_if(std::begin(every_kernel), std::end(every_kernel), [&](const named_kernel& n) { return argv[1] == std::string(n.name); });
  if (k == std::end(every_kernel)) return 2;
  const kernels::row_kernel kernel = kernels::kernel_of(k->which);
  if (kernel == nullptr) return 3;
  std::vector<std::string> wanted(argv + 2, argv + argc);
  traps = std::erase(wanted, "--trap") != 0;
  if (traps) signal(SIGTRAP, count_one);
  const std::vector<picture> pictures = every_picture();
  for (const std::string& name : wanted)
    if (std::none_of(pictures.begin(), pictures.end(), [&](const picture& p) { return name == name_of(p); })) return 2;
  const kernels::layout layout = kernels::layout_of(k->which);
  const ready_map maps[] = {{way::stored, layout}, {way::srgb, layout}, {way::cut_out, layout}};  // by way; the last for all write-outs
  std::vector<rgba8> pixels(size_t(screen.x1) * size_t(screen.y1));
  for (const picture& p : pictures) {
    const std::string name = name_of(p);
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
    instructions = 0;
    if (draw(kernel, maps[std::min(size_t(p.how), std::size(maps) - 1)], p, {pixels.data(), screen.x1, screen.y1, screen.x1}) == 0) std::abort();
    std::printf("%s %d\n", name.c_str(), int(instructions));
  }
}
