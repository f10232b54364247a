// SPDX-License-Identifier: Apache-2.0
// The peers that were built (tools/peers/), loaded from the folder `peers` beside the command.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <sim/draw_host.hpp>
#include <sim/world.hpp>
#include <tools/peers/peer.hpp>

namespace spantex::tool {

using peer_list = std::vector<std::unique_ptr<peers::peer>>;

// Those of the names wanted ("all": every one that is there; "none"). Throws sim::input_error for one that is not there.
peer_list load_peers(const std::vector<std::string>& wanted);

// A plane as the peers take it: one plane over the whole screen, a map that repeats.
bool peers_can_draw(const sim::scene& s);

// Makes a peer ready; false where it has no such filter, or no way to draw what lies behind the viewer. The scene must outlive its drawing.
bool prepare_peer(peers::peer& p, const sim::scene& s, filter kind);
// Of a model; false where it draws no triangles either.
bool prepare_peer(peers::peer& p, const sim::world& shape, sim::screen_size size, filter kind);
sim::image picture_of(const peers::peer& p, sim::screen_size size);

}  // namespace spantex::tool
