// SPDX-License-Identifier: Apache-2.0
#include "drawn.hpp"

mixed::drawn mixed::draw_elsewhere(spantex::filter kind, int picture) { return draw(kind, picture); }
