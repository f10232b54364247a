// SPDX-License-Identifier: Apache-2.0
// expects: nodiscard
// A status is looked at.
#include <spantex/texture.hpp>

void ignore(const spantex::rgba8* const* levels, spantex::texture_view& t) {
  spantex::texture_view::make(levels, 1, 8, 8, spantex::wrap::repeat, spantex::wrap::repeat, t);
}
