// SPDX-License-Identifier: Apache-2.0
#include "map.hpp"

#include <string.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include <spantex/global_memory.hpp>
#include <spantex/pack.hpp>

namespace spantex::sim {

namespace {

std::vector<image> levels_of(image level0, prefilter kind, wrap u, wrap v, colour_space colours, int most_levels) {
  std::vector<image> levels;
  levels.push_back(std::move(level0));
  while ((levels.back().width_px > 1 || levels.back().height_px > 1) && int(levels.size()) != most_levels)
    levels.push_back(halved(levels.back(), kind, u, v, alpha_weighting::independent, 1, colours));
  return levels;
}

// What the levels say without being decoded again: texels that lie in memory as they were given, and formats that have no alpha.
texture_facts facts_of(const std::vector<image>& levels, texel_format format) {
  texture_facts facts{!has_alpha(format), 0};
  if (format != texel_format::rgba8888) return facts;
  facts.opaque = true;
  for (size_t k = 0; k < levels.size(); ++k) {
    const std::vector<rgba8>& texels = levels[k].pixels;
    facts.opaque = facts.opaque && std::all_of(texels.begin(), texels.end(), [](const rgba8& c) { return c.a == 255; });
    const bool uniform = std::all_of(texels.begin(), texels.end(), [&](const rgba8& c) { return c == texels.front(); });
    facts.uniform_levels = uint16_t(facts.uniform_levels | uint16_t(uniform) << k);
  }
  return facts;
}

}  // namespace

texture_map::texture_map(image level0, prefilter kind, wrap u, wrap v, texel_format format, colour_space colours, int most_levels, level_making when) {
  if (when == level_making::at_once) {
    *this = texture_map(levels_of(std::move(level0), kind, u, v, colours, most_levels), u, v, format);
    view_.set_colours(colours);
    return;
  }
  const int width = level0.width_px, height = level0.height_px, all = bit_length(uint64_t(max_of(width, height)));
  const int count = most_levels == 0 ? all : std::min(all, most_levels);
  levels_.resize(size_t(count));
  levels_[0] = std::move(level0);
  waiting_.reset(new waiting{kind, colours, {}, {}});
  if (palette_size(format) != 0) waiting_->indexed = make_palette(levels_[0], palette_size(format));
  // As global_memory lays a map out: each level from a word's beginning, then the palette.
  const auto words_of = [](size_t n) { return (n + 7) / 8; };
  waiting_->first_word.push_back(0);
  for (int k = 0; k < count; ++k) waiting_->first_word.push_back(waiting_->first_word.back() + words_of(level_bytes(format, level_side(width, k), level_side(height, k))));
  const size_t palette_bytes = waiting_->indexed.size() * sizeof(rgba8), palette_at = waiting_->first_word.back();
  memory_.resize(palette_at + words_of(palette_bytes));
  if (palette_bytes != 0) memcpy(&memory_[palette_at], waiting_->indexed.data(), palette_bytes);
  std::vector<const void*> texels;
  for (int k = 0; k < count; ++k) texels.push_back(&memory_[waiting_->first_word[size_t(k)]]);
  const rgba8* const indexed = palette_bytes == 0 ? nullptr : reinterpret_cast<const rgba8*>(&memory_[palette_at]);
  const status s = texture_view::make(format, texels.data(), count, width, height, u, v, view_, indexed, int(waiting_->indexed.size()));
  if (s != status::ok) throw input_error(std::string("map: ") + to_string(s));
  view_.set_colours(colours);
  view_.set_facts({facts_of(levels_, format).opaque, 0});  // where level 0 is opaque, its means are
}

void texture_map::upload_level(int level) const {
  waiting& w = *waiting_;
  if ((w.made >> level & 1) != 0) return;
  for (int k = 1; k <= level; ++k)
    if (levels_[size_t(k)].pixels.empty())
      levels_[size_t(k)] = halved(levels_[size_t(k - 1)], w.kind, view_.wrap_u(), view_.wrap_v(), alpha_weighting::independent, 1, w.colours);
  const image& picture = levels_[size_t(level)];
  const bytes encoded = encode_level(view_.format(), picture, w.indexed);
  memcpy(&memory_[w.first_word[size_t(level)]], encoded.data(), encoded.size());
  const bool uniform = view_.format() == texel_format::rgba8888 && std::all_of(picture.pixels.begin(), picture.pixels.end(), [&](const rgba8& c) { return c == picture.pixels[0]; });
  w.uniform = uint16_t(w.uniform | uint16_t(uniform) << level);
  w.made |= 1u << level;
}

uint64_t texture_map::make_level(int level) const {
  if (!waiting_ || (waiting_->asked >> level & 1) != 0) return 0;
  waiting& w = *waiting_;
  const std::lock_guard<std::mutex> lock(w.one_at_a_time);
  if ((w.asked >> level & 1) != 0) return 0;
  upload_level(level);
  w.asked |= 1u << level;
  return w.first_word[size_t(level) + 1] - w.first_word[size_t(level)];
}

void texture_map::make_all() const {
  if (waiting_->made == (1u << level_count()) - 1) return;
  const std::lock_guard<std::mutex> lock(waiting_->one_at_a_time);
  for (int k = 0; k < level_count(); ++k) upload_level(k);
}

const kernels::planar_map& texture_map::planar(kernels::layout of) const {
  const std::lock_guard<std::mutex> lock(planar_->one_at_a_time);
  if (const auto found = planar_->made.find(of); found != planar_->made.end()) return found->second;
  for (int k = 0; k < level_count(); ++k) make_level(k);
  return planar_->made.emplace(of, kernels::planar_map(view_, of)).first->second;
}

texture_facts texture_map::facts() const {
  return waiting_ ? texture_facts{view_.facts().opaque, waiting_->uniform} : view_.facts();
}

int texture_map::levels_left_out() const {
  if (!pack_.empty()) return 0;
  return bit_length(uint64_t(max_of(view_.width(), view_.height()))) - (waiting_ ? std::popcount(waiting_->asked.load()) : level_count());
}

uint64_t texture_map::words_uploaded() const {
  if (!waiting_) return memory_.size();
  uint64_t words = memory_.size() - waiting_->first_word.back();  // the palette
  for (int k = 0; k < level_count(); ++k)
    if ((waiting_->asked >> k & 1) != 0) words += waiting_->first_word[size_t(k) + 1] - waiting_->first_word[size_t(k)];
  return words;
}

uint64_t texture_map::next_serial() {
  static std::atomic<uint64_t> last{0};
  return ++last;
}

bool same_texels(const texture_map& a, const texture_map& b) {
  const texture_view &x = a.view_, &y = b.view_;
  const bool alike = x.format() == y.format() && x.width() == y.width() && x.height() == y.height() && x.level_count() == y.level_count() && x.wrap_u() == y.wrap_u() &&
                     x.wrap_v() == y.wrap_v();
  if (!alike) return false;
  if (a.waiting_ && b.waiting_)  // all is made from these
    return a.waiting_->kind == b.waiting_->kind && a.waiting_->colours == b.waiting_->colours && a.levels_[0].pixels == b.levels_[0].pixels;
  a.view();
  b.view();
  return a.memory_ == b.memory_ && a.pack_ == b.pack_;
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
  view_.set_facts(facts_of(levels_, format));
}

texture_map::texture_map(bytes pack, const std::string& name) : pack_(std::move(pack)) {
  texture_pack opened;
  const status s = texture_pack::open(pack_.data(), pack_.size(), opened);
  if (s != status::ok) throw input_error(name + ": " + to_string(s));
  view_ = opened.view();
}

}  // namespace spantex::sim
