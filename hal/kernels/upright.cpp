// SPDX-License-Identifier: Apache-2.0
#include "upright.hpp"

#include <algorithm>

#include <spantex/datapath.hpp>
#include "kernel.hpp"
#include "level_rows.hpp"

namespace spantex::kernels {
namespace {

constexpr const profile& by = profiles::standard;
using prof = fixed_profile<profiles::standard>;
static_assert(by.exact_set_up && by.formula == level_formula::jacobian && by.scope == level_scope::pixel);

int32_t centre(int32_t span) { return (2 * span + 1) * span_side; }  // half pixels
int bits_of(int64_t c, int64_t step) { return bit_length(magnitude(c) + reach * magnitude(step)); }
// W below 2 leaves no room for its slope (coordinates_within()), though there is none.
bool upright(const plane& p) { return (p.u.y | p.v.x | p.w.x | p.w.y) == 0 && p.w.c >= 2; }

}  // namespace

rows_between::rows_between(const planar_map& texels, const upright_level& l) {
  const level_rows map(texels, l.level);
  for (int j = 0; j < span_side; ++j) {
    const int32_t y = l.at[j] >> by.subtexel_bits;
    upper[j] = map.row(y);
    lower[j] = map.row(y + 1);
    fraction[j] = l.at[j] & ((1 << by.subtexel_bits) - 1);
  }
}

bool upright_plane::plans(const plane& p, filter kind) { return draws(kind) && !uses_footprint(kind) && upright(p); }

upright_plane::upright_plane(const surface& s, rectangle area)
    : map_(*s.map), texture_(*s.texture), kind_(s.kind), sx_(area.x0 / span_side), end_((area.x1 - 1) / span_side + 1), sy_(area.y0 / span_side),
      wanted_(is_large(area) && plans(map_, kind_)) {}

bool upright_plane::is_large(rectangle area) const {
  const int rows = (area.y1 - 1) / span_side - sy_ + 1;
  return rows >= least_rows && rows * (end_ - sx_) >= least_spans;
}

void upright_plane::find_columns() {
  wanted_ = false;
  inverse_w_ = invert(map_.w.c);
  w_bits_ = bit_length(uint64_t(map_.w.c));
  columns_.reserve(size_t(end_ - sx_));
  for (int32_t sx = sx_; sx < end_; ++sx) {
    const int64_t n = map_.u_at(centre(sx), centre(sy_));
    bool in_range = true;
    const int32_t base = detail::whole_quotient(n, map_.w.c, inverse_w_, in_range);
    const int64_t c = n - base * map_.w.c;
    farthest_base_ = std::max(farthest_base_, std::abs(base));
    columns_.push_back({base, c, bits_of(c, map_.u.x)});
    if (in_range && farthest_base_ <= largest_base(kind_)) continue;
    columns_.clear();
    return;
  }
  const auto [least, most] = std::minmax_element(columns_.begin(), columns_.end(), [](const column& a, const column& b) { return a.bits < b.bits; });
  least_bits_ = least->bits;
  most_bits_ = most->bits;
}

// coordinates_within() of a span whose extent has so many bits, by axis; w is 1 everywhere.
span_coefficients upright_plane::span_of(const column* u, const column* v, int bits) const {
  const int exponent = mantissa_exponent(by, bits - w_bits_ + 1), drop = std::max(0, bits - 31);
  const auto mantissa = [&](int64_t n) { return quotient(n, drop, inverse_w_, exponent); };
  span_coefficients c{};
  if (u != nullptr) {
    c.base_u = u->base;
    c.c_u = mantissa(u->c);
    c.a_u = mantissa(map_.u.x);
  }
  if (v != nullptr) {
    c.base_v = v->base;
    c.c_v = mantissa(v->c);
    c.b_v = mantissa(map_.v.y);
  }
  c.exponent = int8_t(exponent);
  c.how = evaluation::affine;
  c.last_level = uint8_t(texture_.last_level());
  return c;
}

int32_t upright_plane::on_level(coordinate x, uint32_t ratio, bool one, int level) const {
  return kind_ == filter::nearest ? nearest_texel(x, one) : blended(x, ratio, one, level, by);
}

void upright_plane::place_columns(int fine, int levels, table& t) const {
  upright_columns* const on[2] = {&t.fine, &t.coarse};
  uint32_t ratio[2];
  bool one[2];
  for (int n = 0; n < levels; ++n) {
    on[n]->sx = sx_;
    on[n]->at.resize(columns_.size() * span_side);
    ratio[n] = texture_.ratio_u(fine + n);
    one[n] = texture_.width(fine + n) == 1;
  }
  size_t at = 0;
  for (const column& u : columns_) {
    const span_coefficients c = span_of(&u, nullptr, std::max(u.bits, t.row_bits));
    for (int i = 0; i < span_side; ++i, ++at) {
      const coordinate x = position_at(prof{}, c, i, 0).u;
      for (int n = 0; n < levels; ++n) on[n]->at[at] = on_level(x, ratio[n], one[n], fine + n);
    }
  }
}

// False if spans of other lengths have others.
bool upright_plane::place_rows(const column& v, const table& t, int level, int32_t (&at)[span_side]) const {
  for (size_t k = 0; k < t.lengths.size(); ++k) {
    const span_coefficients c = span_of(nullptr, &v, t.lengths[k]);
    for (int j = 0; j < span_side; ++j) {
      const int32_t y = on_level(position_at(prof{}, c, 0, j).v, texture_.ratio_v(level), texture_.height(level) == 1, level);
      if (k > 0 && at[j] != y) return false;
      at[j] = y;
    }
  }
  return true;
}

upright_plane::table& upright_plane::table_of(const column& v, int row_bits) {
  for (table& t : tables_)
    if (t.row_bits == row_bits) return t;
  table& t = tables_.emplace_back();
  t.row_bits = row_bits;
  for (const column& u : columns_) {
    const int bits = std::max(u.bits, row_bits);
    if (std::find(t.lengths.begin(), t.lengths.end(), bits) != t.lengths.end()) continue;
    t.lengths.push_back(bits);
    if (!uses_levels(kind_)) continue;
    span_coefficients c = span_of(&u, &v, bits);
    span_levels(by, c);
    const int32_t level = level_at(prof{}, c, 0, 0);
    t.level = t.lengths.size() == 1 || t.level == level ? level : -1;
    if (t.level < 0) return t;
  }
  const int fine = integer_level(kind_, t.level, by.level_bits, texture_.last_level());
  place_columns(fine, uses_two_levels(kind_) && fine < texture_.last_level() ? 2 : 1, t);
  return t;
}

// Whether spans of that length, with a base so far away, are evaluated about their centres by the rounded forms.
bool upright_plane::known(int bits, int32_t base) const {
  const int extent_log2 = bits - w_bits_ + 1;
  if (extent_log2 > max_extent_log2) return false;
  const int32_t extent = int32_t(2) << std::max(0, by.offset_bits - 1 - mantissa_exponent(by, extent_log2));
  return rounding_is_small(map_, map_.w.c, bit_length(uint64_t(std::max(farthest_base_, std::abs(base)) + extent + 2)));
}

upright_row* upright_plane::row(int32_t sy) {
  if (wanted_) find_columns();
  if (columns_.empty()) return nullptr;
  const reference r = reference_at(map_, centre(sx_), centre(sy));
  const column v{r.base_v, r.c_v, bits_of(r.c_v, r.b_v)};
  const int row_bits = std::max(v.bits, least_bits_);
  if (!r.v_in_range || std::abs(r.base_v) > largest_base(kind_) || !known(std::max(row_bits, most_bits_), r.base_v)) return nullptr;
  table& t = table_of(v, row_bits);
  if (t.level < 0) return nullptr;
  const int fine = integer_level(kind_, t.level, by.level_bits, texture_.last_level());
  row_.fraction = uses_two_levels(kind_) ? t.level - (fine << by.level_bits) : 0;
  row_.fine.level = fine;
  row_.fine.columns = &t.fine;
  row_.coarse.level = fine + 1;
  row_.coarse.columns = &t.coarse;
  if (!place_rows(v, t, fine, row_.fine.at)) return nullptr;
  return row_.fraction == 0 || place_rows(v, t, fine + 1, row_.coarse.at) ? &row_ : nullptr;
}

}  // namespace spantex::kernels
