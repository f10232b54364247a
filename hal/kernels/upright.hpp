// SPDX-License-Identifier: Apache-2.0
// Planes that are scaled along their axes, neither turned nor divided: a column of pixels lies in one column of the map, a row in one row, and all of them on one level,
// so that they are planned once, not span by span. A span's mantissas share an exponent, which follows from the longer of its two axes (docs/SPEC.md, section 4):
// positions of columns are the same in all rows of spans that are as long, and for each length there is a table.
#pragma once
#include <stdint.h>

#include <vector>

#include <spantex/draw.hpp>
#include "planar_map.hpp"

namespace spantex::kernels {

// Where columns of pixels lie on a level before any wrapping, from span `sx` on: 2^-subtexel_bits texel; texels for nearest.
struct upright_columns {
  int32_t sx;
  std::vector<int32_t> at;
  // A kernel's own, made the first time that it meets the columns: numbers, empty until then; which way they are drawn; whether another kernel is to draw them.
  std::vector<int32_t> prepared;
  int way = 0;
  bool left = false;
};

// A row of spans on a level.
struct upright_level {
  int level;
  upright_columns* columns;
  int32_t at[span_side];  // the rows of pixels, likewise
};

struct upright_row {
  upright_level fine, coarse;  // fine alone where the fraction is 0
  int32_t fraction;            // of 2^level_bits
};

// The rows of texels that the rows of pixels lie between, and how far below the upper ones, of 2^subtexel_bits.
struct rows_between {
  const rgba8 *upper[span_side], *lower[span_side];
  int32_t fraction[span_side];
  rows_between(const planar_map& texels, const upright_level& l);
};

// Of a surface, profile default. Tables are made when the first row is asked for.
class upright_plane {
 public:
  static constexpr int least_rows = 2, least_spans = 8;  // fewer are drawn sooner one by one
  static bool plans(const plane& p, filter kind);  // areas that are large enough
  upright_plane(const surface& s, rectangle area);

  // Null where the row's spans must be planned one by one. What it returned before is then gone.
  upright_row* row(int32_t sy);

 private:
  struct column { int32_t base; int64_t c; int bits; };  // bits of the extent
  struct table {
    int row_bits;
    std::vector<int> lengths;  // of spans, extents' bits: all there are
    int32_t level;             // of detail, the same for all of them; or less than 0
    upright_columns fine, coarse;
  };
  bool is_large(rectangle area) const;
  void find_columns();
  span_coefficients span_of(const column* u, const column* v, int bits) const;
  table& table_of(const column& v, int row_bits);
  void place_columns(int fine, int levels, table& t) const;
  bool place_rows(const column& v, const table& t, int level, int32_t (&at)[span_side]) const;
  int32_t on_level(coordinate x, uint32_t ratio, bool one, int level) const;
  bool known(int bits, int32_t base) const;

  const plane& map_;
  const texture_view& texture_;
  filter kind_;
  int32_t sx_, end_, sy_;  // spans
  bool wanted_;            // and not begun
  int32_t farthest_base_ = 0;
  inverse inverse_w_{};
  int w_bits_ = 0, least_bits_ = 0, most_bits_ = 0;
  std::vector<column> columns_;  // none: nothing is upright
  std::vector<table> tables_;
  upright_row row_{};
};

}  // namespace spantex::kernels
