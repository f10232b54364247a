// SPDX-License-Identifier: Apache-2.0
#include "drawn.hpp"

uint16_t mixed::frame_pixels[mixed::width * mixed::height];
spantex::app::map_texels mixed::texels;

int main() {
  mixed::texels.make();
  constexpr int pictures[] = {1, 3, 4};  // tilted, rolled, a quad
  int wrong = 0;
  for (const spantex::filter kind : spantex::app::row_filters)
    for (const int picture : pictures) {
      const mixed::drawn here = mixed::draw(kind, picture), there = mixed::draw_elsewhere(kind, picture);
      if (here.beside || there.beside || here.hash != there.hash) ++wrong;
      console::print_hex(here.hash);
      console::print(here.hash == there.hash ? "\n" : " and another\n");
      if (here.beside || there.beside) console::print("memory behind the state was written\n");
    }
  return wrong == 0 ? 0 : 1;
}
