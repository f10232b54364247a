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
// The bench's, and what has a way of its own: W constant, and no turn besides.
constexpr named_plane planes[] = {{"facing", sim::facing_plane}, {"tilted", sim::tilted_plane}, {"grazing", sim::grazing_plane}, {"close", sim::close_plane}, {"far", sim::far_plane},
                                  {"turned", {0.8, -0.3, 100, 0.3, 0.8, 20, 0, 0, 1}}, {"scaled", {0.73, 0, 11.3, 0, 0.61, 5.7, 0, 0, 1}}};

struct named_filter { const char* name; filter kind; };
constexpr named_filter filters[] = {{"nearest", filter::nearest}, {"bilinear", filter::bilinear}, {"mip-bilinear", filter::mip_bilinear}, {"trilinear", filter::trilinear}, {"aniso", filter::aniso}};

struct named_kernel { const char* name; kernels::choice which; };
constexpr named_kernel every_kernel[] = {{"words", kernels::choice::words}, {"sse41", kernels::choice::sse41}, {"avx2", kernels::choice::avx2}, {"avx512", kernels::choice::avx512},
                                         {"avx512-gathers", kernels::choice::avx512_gathers}, {"neon", kernels::choice::neon}};

std::string name_of(const named_plane& p, const named_filter& f) { return std::string(p.name) + "-" + f.name; }

bool is_picture(const std::string& name) {
  return std::any_of(std::begin(planes), std::end(planes), [&](const named_plane& p) {
    return std::any_of(std::begin(filters), std::end(filters), [&](const named_filter& f) { return name == name_of(p, f); });
  });
}

struct noise {
  std::vector<std::vector<rgba8>> levels;
  texture_view view;

  noise() {
    uint32_t state = 7;
    std::vector<const rgba8*> first;
    for (int side = map_side; side >= 1; side /= 2) {
      std::vector<rgba8>& level = levels.emplace_back(size_t(side) * size_t(side));
      for (rgba8& t : level) {
        state = state * 1664525u + 1013904223u;
        t = {uint8_t(state >> 24), uint8_t(state >> 16), uint8_t(state >> 8), 255};
      }
    }
    for (const std::vector<rgba8>& level : levels) first.push_back(level.data());
    if (texture_view::make(first.data(), int(first.size()), map_side, map_side, wrap::repeat, wrap::repeat, view) != status::ok) std::abort();
  }
};

plane made(const named_plane& named) {
  plane p;
  if (make_plane(sim::to_homography(named.m), screen, p) != status::ok) std::abort();
  return p;
}

[[gnu::noinline]] uint64_t draw_counted(kernels::row_kernel kernel, const kernels::planar_map& texels, const plane& p, const texture_view& view, filter kind, const frame_buffer& frame) {
  count_begin();
  direct_engine<prof> engine;
  renderer<direct_engine<prof>, prof> rest(engine, prof{}, frame);
  draw_counters counts;
  status done = kernels::draw_plane(kernel, texels, rest, p, view, kind, drawn, frame, counts);
  if (done == status::ok) done = rest.finish();
  count_end();
  if (done != status::ok) std::abort();
  return counts.jobs;
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
  for (const std::string& name : wanted)
    if (!is_picture(name)) return 2;
  const noise map;
  const kernels::planar_map texels(map.view, kernels::layout_of(k->which));
  std::vector<rgba8> pixels(size_t(screen.x1) * size_t(screen.y1));
  for (const named_plane& named : planes) {
    const plane p = made(named);
    for (const named_filter& f : filters) {
      const std::string name = name_of(named, f);
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
      instructions = 0;
      if (draw_counted(kernel, texels, p, map.view, f.kind, {pixels.data(), screen.x1, screen.y1, screen.x1}) == 0) std::abort();
      std::printf("%s %d\n", name.c_str(), int(instructions));
    }
  }
}
