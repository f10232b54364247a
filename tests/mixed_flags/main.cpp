// SPDX-License-Identifier: Apache-2.0
#include "drawn.hpp"

uint16_t mixed::frame_pixels[mixed::width * mixed::height];
spantex::app::map_texels mixed::texels;

int main() {
  mixed::texels.make();
  constexpr int pictures[] = {1, 3, 4};  // tilted, rolled, a quad
  for (const spantex::filter kind : spantex::app::row_filters)
    for (const int picture : pictures) {
      const mixed::drawn here = mixed::draw(kind, picture), there = mixed::draw_elsewhere(kind, picture);
      console::print_hex(here.hash);
      console::print(here.hash == there.hash ? "" : " and another");
      console::print(here.beside || there.beside ? ", memory behind the state written\n" : "\n");
    }
  return 0;
}
