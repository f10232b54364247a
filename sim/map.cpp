// SPDX-License-Identifier: Apache-2.0
#include "map.hpp"

#include <utility>

#include <spantex/global_memory.hpp>
#include <spantex/pack.hpp>

namespace spantex::sim {

namespace {

std::vector<image> levels_of(image level0, prefilter kind, wrap u, wrap v, colour_space colours) {
  std::vector<image> levels;
  levels.push_back(std::move(level0));
  while (levels.back().width_px > 1 || levels.back().height_px > 1)
    levels.push_back(halved(levels.back(), kind, u, v, alpha_weighting::independent, 1, colours));
  return levels;
}

}  // namespace

texture_map::texture_map(image level0, prefilter kind, wrap u, wrap v, texel_format format, colour_space colours)
    : texture_map(levels_of(std::move(level0), kind, u, v, colours), u, v, format) {
  view_.set_colours(colours);
}

void texture_map::set_contour(const contour_style& style) {
  if (const status s = view_.set_contour(style); s != status::ok) throw input_error(std::string("contour: ") + to_string(s));
}

texture_map::texture_map(std::vector<image> levels, wrap u, wrap v, texel_format format) : levels_(std::move(levels)) {
  const image& top = levels_.front();
  palette colours;
  if (palette_size(format) != 0) colours = make_palette(top, palette_size(format));
  std::vector<bytes> encoded;
  std::vector<const void*> texels;
  for (const image& level : levels_) encoded.push_back(encode_level(format, level, colours));
  for (const bytes& level : encoded) texels.push_back(level.data());
  const int count = int(texels.size()), width = top.width_px, height = top.height_px;
  memory_.resize(global_memory::words_for(format, count, width, height, int(colours.size())));
  global_memory memory(memory_.data(), memory_.size());
  const status s = memory.upload(format, texels.data(), count, width, height, u, v, view_, colours.data(), int(colours.size()));
  if (s != status::ok) throw input_error(std::string("map: ") + to_string(s));
}

texture_map::texture_map(bytes pack, const std::string& name) : pack_(std::move(pack)) {
  texture_pack opened;
  const status s = texture_pack::open(pack_.data(), pack_.size(), opened);
  if (s != status::ok) throw input_error(name + ": " + to_string(s));
  view_ = opened.view();
}

}  // namespace spantex::sim
