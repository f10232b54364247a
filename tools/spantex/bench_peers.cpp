// SPDX-License-Identifier: Apache-2.0
#include "bench_peers.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "options.hpp"

namespace spantex::tool {
namespace {

// Files of build/peers, and what each must export.
using make_function = peers::peer* (*)();

std::filesystem::path folder() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return self.parent_path() / "peers";
}

// Never unloaded: a peer's library may keep threads or handlers.
std::unique_ptr<peers::peer> load(const std::filesystem::path& file) {
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw sim::input_error(std::string("--peers: ") + dlerror());
  const auto make = reinterpret_cast<make_function>(dlsym(library, "spantex_make_peer"));
  if (make == nullptr) throw sim::input_error("--peers: " + file.string() + " is not a peer");
  std::unique_ptr<peers::peer> made(make());
  if (made == nullptr) throw sim::input_error("--peers: " + file.string() + " cannot run here");
  return made;
}

std::vector<std::string> built() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder(), error))
    if (entry.path().extension() == ".so") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<peers::sampling> sampling_of(filter kind) {
  switch (kind) {
    case filter::nearest: return peers::sampling::nearest;
    case filter::bilinear: return peers::sampling::bilinear;
    case filter::mip_bilinear: return peers::sampling::mip_bilinear;
    case filter::trilinear: return peers::sampling::trilinear;
    case filter::aniso: return peers::sampling::aniso16;
    default: return std::nullopt;
  }
}

std::vector<peers::level> levels_of(const sim::texture_map& map) {
  std::vector<peers::level> levels;
  for (int k = 0; k < map.level_count(); ++k) {
    const sim::image& level = map.level(k);
    levels.push_back({reinterpret_cast<const uint8_t*>(level.pixels.data()), level.width_px, level.height_px});
  }
  return levels;
}

peers::wrapping wrapping_of(wrap w) { return w == wrap::repeat ? peers::wrapping::repeat : w == wrap::clamp ? peers::wrapping::clamp : peers::wrapping::mirror; }

// Of a convex face, corner after corner.
void add_triangles(std::vector<peers::corner>& to, const sim::world_face& face, const peers::level& map) {
  const auto add = [&](const sim::world_vertex& v) {
    to.push_back({float(v.position[0]), float(v.position[1]), float(v.position[2]), float(v.u / map.width), float(v.v / map.height)});
  };
  for (size_t k = 2; k < face.corners.size(); ++k)
    for (const size_t corner : {size_t(0), k - 1, k}) add(face.corners[corner]);
}

}  // namespace

peer_list load_peers(const std::vector<std::string>& wanted) {
  refuse_repeats("--peers", wanted);
  const std::vector<std::string> there = built();
  std::vector<std::string> names = wanted;
  if (wanted == std::vector<std::string>{"all"}) names = there;
  if (wanted == std::vector<std::string>{"none"}) names.clear();
  peer_list all;
  for (const std::string& name : names) {
    if (std::find(there.begin(), there.end(), name) == there.end())
      throw sim::input_error("--peers: '" + name + "' is not built (" + (there.empty() ? "none is" : "built: " + joined(there)) + ")");
    all.push_back(load(folder() / (name + ".so")));
  }
  return all;
}

bool peers_can_draw(const sim::scene& s) {
  if (s.items.size() != 1 || s.items[0].is_polygon) return false;
  const texture_view& t = s.texture(s.items[0]);
  return t.wrap_u() == wrap::repeat && t.wrap_v() == wrap::repeat;
}

bool prepare_peer(peers::peer& p, const sim::scene& s, filter kind) {
  const std::optional<peers::sampling> sampling = sampling_of(kind);
  if (!sampling) return false;
  const sim::texture_map& map = (*s.maps)[size_t(s.items[0].map_index)];
  const std::vector<peers::level> levels = levels_of(map);
  peers::task task{levels.data(), int(levels.size()), {}, s.size.width_px, s.size.height_px, *sampling, map.view_on_demand().colours() == colour_space::srgb && kind != filter::nearest};
  std::copy(s.items[0].plane_matrix.begin(), s.items[0].plane_matrix.end(), task.matrix);
  return p.prepare(task);
}

bool prepare_peer(peers::peer& p, const sim::world& shape, sim::screen_size size, filter kind) {
  const std::optional<peers::sampling> sampling = sampling_of(kind);
  if (!sampling) return false;
  const size_t maps = shape.maps->size();
  std::vector<std::vector<peers::level>> levels;
  for (const sim::texture_map& map : *shape.maps) levels.push_back(levels_of(map));
  std::vector<std::vector<peers::corner>> corners(maps);
  for (const sim::world_face& face : shape.faces) add_triangles(corners[size_t(face.map_index)], face, levels[size_t(face.map_index)][0]);
  std::vector<peers::mesh> meshes;
  for (size_t k = 0; k < maps; ++k) {
    const texture_view& view = (*shape.maps)[k].view();
    if (!corners[k].empty())
      meshes.push_back({corners[k].data(), int(corners[k].size()), levels[k].data(), int(levels[k].size()), wrapping_of(view.wrap_u()), wrapping_of(view.wrap_v())});
  }
  return p.prepare(peers::model_task{meshes.data(), int(meshes.size()), size.width_px, size.height_px, *sampling});
}

sim::image picture_of(const peers::peer& p, sim::screen_size size) {
  sim::image picture(size.width_px, size.height_px, {});
  static_assert(sizeof(rgba8) == 4);
  p.read(reinterpret_cast<uint8_t*>(picture.pixels.data()));
  return picture;
}

}  // namespace spantex::tool
