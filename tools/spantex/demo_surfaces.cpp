// SPDX-License-Identifier: Apache-2.0
// Surfaces that are not opaque, for the demo: three panes behind each other, cut out, blended, premultiplied, and with colours at their corners.
// The reference is opaque, so these pictures are for looking at; the rules of write-out are held by tests/unit/shade.cpp.
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <sim/figures.hpp>
#include <sim/pack.hpp>
#include <sim/pattern.hpp>
#include <sim/scene.hpp>
#include "demo_surfaces.hpp"

namespace spantex::tool {
namespace {

constexpr int side = 256;

// Photographic colours; alpha is 255 in the mask's shapes and `outside` elsewhere.
sim::image pane_map(uint8_t outside, bool premultiplied) {
  sim::image map = sim::photographic_pattern(side, 3);
  const sim::image mask = sim::shapes_mask(side);
  for (size_t k = 0; k < map.pixels.size(); ++k) {
    rgba8& c = map.pixels[k];
    c.a = uint8_t(outside + (255 - outside) * mask.pixels[k].r / 255);
    if (premultiplied)
      for (uint8_t* x : {&c.r, &c.g, &c.b}) *x = uint8_t((*x * c.a + 127) / 255);
  }
  return map;
}

// Panes from far to near, each turned about its upright axis.
sim::scene panes(const char* name, const sim::image& map, const sim::compile_options& levels, const rgba8 (&corners)[4]) {
  sim::map_list maps;
  maps.emplace_back(sim::compile_pack(map, levels), name);
  sim::scene s{name, {640, 480}, std::make_shared<const sim::map_list>(std::move(maps)), {}};
  const sim::lens view = sim::make_lens(s.size, 0.9, 0.1);
  for (int k = 0; k < 3; ++k) {
    const double turn = 0.9 - 0.6 * k, middle_x = 1.1 - 1.0 * k, middle_z = 5 - 1.1 * k;
    vertex v[4]{};
    for (int corner = 0; corner < 4; ++corner) {
      const double across = corner == 1 || corner == 2 ? 1 : -1, down = corner >= 2 ? 1 : -1;
      v[corner] = {sim::to_fixed(middle_x + across * std::cos(turn)), sim::to_fixed(down), sim::to_fixed(middle_z + across * std::sin(turn)),
                   sim::to_fixed((across + 1) / 2 * side), sim::to_fixed((down + 1) / 2 * side)};
    }
    sim::add_polygon(s, view, v, corners, 4, 0);
  }
  return s;
}

}  // namespace

void draw_surfaces(sim::draw_options how, const std::string& folder) {
  constexpr rgba8 plain[4] = {white, white, white, white};
  constexpr rgba8 coloured[4] = {{255, 64, 64, 255}, {255, 255, 64, 255}, {64, 255, 64, 255}, {64, 64, 255, 255}};
  sim::compile_options weighted, kept;
  weighted.alpha = kept.alpha = sim::alpha_weighting::weighted;
  kept.alpha_threshold = 128;
  const auto write = [&](const sim::scene& s, alpha_mode alpha) {
    how.how.alpha = alpha;
    sim::output_file(folder + "/" + s.name + "-" + std::string(sim::name_of(sim::filter_names, how.kind)) + ".png").write(sim::encode_png(sim::draw(s, how).picture));
  };
  how.kind = filter::trilinear;
  write(panes("cut-out", pane_map(0, false), kept, plain), alpha_mode::cut_out);
  write(panes("blended", pane_map(64, false), weighted, plain), alpha_mode::blended);
  write(panes("premultiplied", pane_map(64, true), {}, plain), alpha_mode::premultiplied);
  write(panes("vertex-colours", pane_map(255, false), {}, coloured), alpha_mode::opaque);
}

}  // namespace spantex::tool
