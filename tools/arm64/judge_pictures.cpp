// SPDX-License-Identifier: Apache-2.0
// For tools/count_arm64: the planes of `spantex bench` with its map and reference, for programs of another machine.
//   judge_pictures task SCENE SIZE OUT              the plane in a file (task_file.hpp)
//   judge_pictures judge SCENE SIZE < "FILTER FILE" lines    "PSNR right|wrong same|other" each: nearer the reference than its mean colour; the bytes that we draw here
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <fstream>
#include <iostream>
#include <string>

#include <sim/draw_host.hpp>
#include <sim/pattern.hpp>
#include <sim/quality.hpp>
#include <tools/bench_planes.hpp>

#include "task_file.hpp"

namespace spantex::arm64 {
namespace {

constexpr int map_side = 512;
constexpr rgba8 background{0, 0, 0, 255};

sim::scene scene_of(const std::string& name, const char* size) {
  sim::screen_size s{};
  const auto plane = tool::bench_plane(name);
  if (sscanf(size, "%dx%d", &s.width_px, &s.height_px) != 2 || !plane) throw sim::input_error("no such size or plane");
  sim::map_list maps;
  maps.emplace_back(sim::photographic_pattern(map_side, 1), sim::prefilter::box, wrap::repeat, wrap::repeat);
  sim::scene made{name, s, std::make_shared<const sim::map_list>(std::move(maps)), {}};
  sim::add_plane(made, sim::stretched(*plane, s), 0);
  return made;
}

void write_task(const sim::scene& s, const char* file) {
  std::ofstream out(file, std::ios::binary);
  const auto bytes = [&](const void* from, size_t count) { out.write(static_cast<const char*>(from), std::streamsize(count)); };
  const sim::texture_map& map = s.map_of(s.items[0]);
  task_header header{s.size.width_px, s.size.height_px, map.level_count(), 0, {}};
  std::copy(s.items[0].plane_matrix.begin(), s.items[0].plane_matrix.end(), header.matrix);
  bytes(&header, sizeof header);
  for (int k = 0; k < map.level_count(); ++k) {
    const sim::image& level = map.level(k);
    const int32_t sides[] = {level.width_px, level.height_px};
    bytes(sides, sizeof sides);
    bytes(level.pixels.data(), level.pixels.size() * sizeof(rgba8));
  }
  if (!out.flush()) throw sim::input_error(std::string(file) + ": cannot write");
}

void judge(const sim::scene& s) {
  const sim::ideal_image reference = sim::render_reference(s, background, 1);
  const double flat_db = sim::flat_psnr_db(reference);
  std::string kind, file;
  while (std::cin >> kind >> file) {
    sim::image picture(s.size.width_px, s.size.height_px, {});
    std::ifstream in(file, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(picture.pixels.data()), std::streamsize(picture.pixels.size() * sizeof(rgba8)))) throw sim::input_error(file + ": cannot read");
    sim::draw_options o;
    o.background = background;
    for (const auto& f : sim::filter_names)
      if (f.name == kind) o.kind = f.value;
    const double db = sim::psnr_db(picture, reference);
    printf("%.6f %s %s\n", db, db > flat_db ? "right" : "wrong", sim::draw(s, o).picture.pixels == picture.pixels ? "same" : "other");
  }
}

}  // namespace
}  // namespace spantex::arm64

int main(int argc, char** argv) {
  using namespace spantex;
  try {
    if (argc < 4) throw sim::input_error("judge_pictures task|judge SCENE SIZE [OUT]");
    const sim::scene s = arm64::scene_of(argv[2], argv[3]);
    if (argc > 4 && strcmp(argv[1], "task") == 0) arm64::write_task(s, argv[4]);
    else arm64::judge(s);
  } catch (const std::exception& e) {
    fprintf(stderr, "judge_pictures: %s\n", e.what());
    return 1;
  }
}
