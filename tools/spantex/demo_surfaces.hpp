// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include <sim/draw_host.hpp>

namespace spantex::tool {

// Writes cut-out, blended, premultiplied and vertex-colours into the folder.
void draw_surfaces(sim::draw_options how, const std::string& folder);

}  // namespace spantex::tool
