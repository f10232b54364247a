// SPDX-License-Identifier: Apache-2.0
// For tools/count_arm64, which counts the instructions from count_begin to count_end: what `spantex bench` times. No part of the simulator.
//   count_pictures FILTER PEER.so|ours TASK...    each to TASK.rgba, by the NEON kernel (the scalar engine where that has not the filter) or a peer; prints who drew
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <hal/direct_engine.hpp>
#include <hal/kernels/rows.hpp>
#include <sim/ideal.hpp>
#include <tools/peers/peer.hpp>

#include "task_file.hpp"

extern "C" {
[[gnu::noinline, gnu::used]] void count_begin() { asm volatile(""); }
[[gnu::noinline, gnu::used]] void count_end() { asm volatile(""); }
}

namespace spantex::arm64 {
namespace {

constexpr int warm_ups = 2;  // of a peer, which may compile when it draws first

struct named_filter { const char* name; filter kind; peers::sampling sampling; };
constexpr named_filter filters[] = {{"nearest", filter::nearest, peers::sampling::nearest}, {"bilinear", filter::bilinear, peers::sampling::bilinear},
                                    {"trilinear", filter::trilinear, peers::sampling::trilinear}, {"aniso", filter::aniso, peers::sampling::aniso16}};

struct task {
  task_header header;
  struct level { int32_t sides[2]; std::vector<rgba8> texels; };
  std::vector<level> levels;
  std::vector<rgba8> picture;

  bool read(const char* file) {
    std::ifstream in(file, std::ios::binary);
    const auto bytes = [&](void* to, size_t count) { return bool(in.read(static_cast<char*>(to), std::streamsize(count))); };
    if (!bytes(&header, sizeof header)) return false;
    levels.resize(size_t(header.level_count));
    for (level& l : levels) {
      if (!bytes(l.sides, sizeof l.sides)) return false;
      l.texels.resize(size_t(l.sides[0]) * size_t(l.sides[1]));
      if (!bytes(l.texels.data(), l.texels.size() * sizeof(rgba8))) return false;
    }
    picture.resize(size_t(header.width) * size_t(header.height));
    return true;
  }
};

const char* draw_ours(task& t, filter kind) {
  using prof = fixed_profile<profiles::standard>;
  std::vector<const rgba8*> levels;
  for (const task::level& l : t.levels) levels.push_back(l.texels.data());
  texture_view view;
  sim::matrix m;
  std::copy(t.header.matrix, t.header.matrix + 9, m.begin());
  const rectangle all{0, 0, t.header.width, t.header.height};
  plane p;
  if (texture_view::make(levels.data(), int(levels.size()), t.levels[0].sides[0], t.levels[0].sides[1], wrap::repeat, wrap::repeat, view) != status::ok) return "";
  if (make_plane(sim::to_homography(m), all, p) != status::ok) return "";
  const kernels::planar_map texels(view, kernels::layout_of(kernels::choice::neon));
  const kernels::row_kernel kernel = kernels::draws(kind) ? kernels::neon_kernel() : nullptr;
  count_begin();
  const auto engine = std::make_unique<direct_engine<prof>>();
  const frame_buffer frame{t.picture.data(), all.x1, all.y1, all.x1};
  renderer<direct_engine<prof>, prof> r(*engine, prof{}, frame);
  draw_counters counts;
  status done = kernel == nullptr ? r.draw(p, view, kind, all) : kernels::draw_plane(kernel, texels, r, p, view, kind, all, frame, counts);
  if (done == status::ok) done = r.finish();
  count_end();
  if (done != status::ok) return "";
  return kernel == nullptr ? "scalar" : "neon";
}

peers::peer* load(const char* file) {
  void* const library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) fprintf(stderr, "%s\n", dlerror());
  return library == nullptr ? nullptr : reinterpret_cast<peers::peer* (*)()>(dlsym(library, "spantex_make_peer"))();
}

bool draw_by(peers::peer& peer, task& t, peers::sampling kind) {
  std::vector<peers::level> levels;
  for (const task::level& l : t.levels) levels.push_back({reinterpret_cast<const uint8_t*>(l.texels.data()), l.sides[0], l.sides[1]});
  peers::task wanted{levels.data(), int(levels.size()), {}, t.header.width, t.header.height, kind};
  memcpy(wanted.matrix, t.header.matrix, sizeof wanted.matrix);
  if (!peer.prepare(wanted)) return false;
  for (int k = 0; k < warm_ups; ++k) peer.draw();
  count_begin();
  peer.draw();
  count_end();
  peer.read(reinterpret_cast<uint8_t*>(t.picture.data()));
  return true;
}

int run(int argc, char** argv) {
  if (argc < 4) return 2;
  const bool ours = strcmp(argv[2], "ours") == 0;
  peers::peer* const peer = ours ? nullptr : load(argv[2]);
  if (!ours && peer == nullptr) return 1;
  for (const named_filter& f : filters) {
    if (strcmp(f.name, argv[1]) != 0) continue;
    std::string drawer;
    for (int k = 3; k < argc; ++k) {
      task t;
      if (!t.read(argv[k])) return 2;
      if (ours) drawer = draw_ours(t, f.kind);
      else if (draw_by(*peer, t, f.sampling)) drawer = std::string(peer->name()) + " " + peer->version();
      else return 1;
      std::ofstream out(std::string(argv[k]) + ".rgba", std::ios::binary);
      if (!out.write(reinterpret_cast<const char*>(t.picture.data()), std::streamsize(t.picture.size() * sizeof(rgba8))).flush()) return 2;
    }
    puts(drawer.c_str());
    fflush(stdout);
    _Exit(drawer.empty() ? 1 : 0);  // peers' libraries keep threads
  }
  return 2;
}

}  // namespace
}  // namespace spantex::arm64

int main(int argc, char** argv) { return spantex::arm64::run(argc, argv); }
