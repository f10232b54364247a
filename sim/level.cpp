// SPDX-License-Identifier: Apache-2.0
#include "level.hpp"

#include <math.h>
#include <stdio.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "archive.hpp"

namespace spantex::sim {
namespace {

namespace fs = std::filesystem;

// Records of one lump, little-endian.
struct lump {
  const uint8_t* data;
  size_t record_bytes, count;

  uint32_t u32(size_t k, size_t offset) const {
    const uint8_t* p = data + k * record_bytes + offset;
    return uint32_t(p[0]) | uint32_t(p[1]) << 8 | uint32_t(p[2]) << 16 | uint32_t(p[3]) << 24;
  }
  float f32(size_t k, size_t offset) const { return std::bit_cast<float>(u32(k, offset)); }
  bool holds(uint64_t first, uint64_t n) const { return first <= count && n <= count - first; }
};

enum : size_t { entities_lump, textures_lump, vertices_lump = 10, indices_lump, faces_lump = 13, lump_count = 17 };
enum face_type : uint32_t { polygon_face = 1, patch_face, mesh_face };
constexpr uint32_t sky = 0x4, not_drawn = 0x80;  // surface flags of a texture
constexpr size_t texture_name_bytes = 64;
constexpr uint64_t most_triangles = 1 << 20;

struct bsp {
  std::string name;
  const bytes& file;

  bsp(std::string name_, const bytes& data) : name(std::move(name_)), file(data) {
    constexpr std::string_view magic = "IBSP";
    constexpr uint32_t version = 46;
    if (file.size() < 8 + 8 * lump_count || !std::equal(magic.begin(), magic.end(), file.begin())) throw input_error(name + ": not a Quake III map");
    if (header(4) != version) throw input_error(name + ": map of version " + std::to_string(header(4)) + ", not 46");
  }
  lump part(size_t index, size_t record_bytes) const {
    const uint64_t at = header(8 + 8 * index), size = header(12 + 8 * index);
    if (at + size > file.size()) throw input_error(name + ": damaged: lump " + std::to_string(index) + " ends beyond the file");
    return {file.data() + at, record_bytes, size_t(size / record_bytes)};
  }

 private:
  uint32_t header(size_t at) const { return lump{file.data(), 1, file.size()}.u32(at, 0); }
};

vector3d y_up(double x, double y, double z) { return {x, z, -y}; }

struct face_reader {
  const bsp& map;
  lump vertices = map.part(vertices_lump, 44), indices = map.part(indices_lump, 4), faces = map.part(faces_lump, 104);
  lump textures = map.part(textures_lump, texture_name_bytes + 8);
  std::vector<world_face> out{};  // coordinates in periods of the map, map_index the texture's

  input_error damaged(size_t face) const { return input_error(map.name + ": damaged: face " + std::to_string(face) + " names what is not there"); }

  // Counted before they are made: faces may be made of the same vertices, so that a small file names any number of triangles.
  void read() {
    uint64_t triangles = 0;
    for (size_t k = 0; k < faces.count; ++k) triangles += triangles_of(k);
    if (triangles > most_triangles) throw input_error(map.name + ": " + std::to_string(triangles) + " triangles, more than " + std::to_string(most_triangles));
    out.reserve(size_t(triangles));
    for (size_t k = 0; k < faces.count; ++k) {
      if (triangles_of(k) == 0) continue;
      if (faces.u32(k, 8) == patch_face) read_patches(k, int(faces.u32(k, 0)));
      else read_triangles(k, int(faces.u32(k, 0)));
    }
  }

 private:
  static constexpr size_t patch_steps = 4;

  // None of a face that is not drawn.
  uint64_t triangles_of(size_t k) const {
    const uint32_t texture = faces.u32(k, 0), type = faces.u32(k, 8);
    if (texture >= textures.count) throw damaged(k);
    if ((textures.u32(texture, texture_name_bytes) & (sky | not_drawn)) != 0) return 0;
    if (!vertices.holds(faces.u32(k, 12), faces.u32(k, 16)) || !indices.holds(faces.u32(k, 20), faces.u32(k, 24))) throw damaged(k);
    if (type == polygon_face || type == mesh_face) return faces.u32(k, 24) / 3;
    if (type != patch_face) return 0;
    const size_t width = faces.u32(k, 96), height = faces.u32(k, 100);
    constexpr size_t most = 1025;
    const bool good = width >= 3 && height >= 3 && width % 2 == 1 && height % 2 == 1 && width <= most && height <= most && width * height <= faces.u32(k, 16);
    if (!good) throw damaged(k);
    return (width / 2) * (height / 2) * 2 * patch_steps * patch_steps;
  }

  world_vertex at(size_t k) const {
    const world_vertex v{y_up(vertices.f32(k, 0), vertices.f32(k, 4), vertices.f32(k, 8)), vertices.f32(k, 12), vertices.f32(k, 16)};
    for (const double x : {v.position[0], v.position[1], v.position[2], v.u, v.v})
      if (!std::isfinite(x)) throw input_error(map.name + ": a vertex is not a finite number");
    return v;
  }

  void read_triangles(size_t k, int texture) {
    const size_t first = faces.u32(k, 12), count = faces.u32(k, 16), first_index = faces.u32(k, 20);
    for (size_t n = 0; n + 3 <= faces.u32(k, 24); n += 3) {
      world_face f{{}, texture};
      for (size_t c = 0; c < 3; ++c) {
        const size_t index = indices.u32(first_index + n + c, 0);
        if (index >= count) throw damaged(k);
        f.corners.push_back(at(first + index));
      }
      out.push_back(std::move(f));
    }
  }

  // A grid of control points, odd x odd: every 3x3 of them, neighbours sharing a row, are a biquadratic Bezier patch.
  void read_patches(size_t k, int texture) {
    const size_t first = faces.u32(k, 12), width = faces.u32(k, 96), height = faces.u32(k, 100);
    for (size_t j = 0; j + 2 < height; j += 2)
      for (size_t i = 0; i + 2 < width; i += 2) add_patch(first + j * width + i, width, texture);
  }

  void add_patch(size_t corner, size_t stride, int texture) {
    constexpr size_t steps = patch_steps;
    world_vertex grid[steps + 1][steps + 1];
    for (size_t j = 0; j <= steps; ++j)
      for (size_t i = 0; i <= steps; ++i) grid[j][i] = on_patch(corner, stride, double(i) / steps, double(j) / steps);
    for (size_t j = 0; j < steps; ++j)
      for (size_t i = 0; i < steps; ++i) {
        out.push_back({{grid[j][i], grid[j][i + 1], grid[j + 1][i]}, texture});
        out.push_back({{grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i]}, texture});
      }
  }

  world_vertex on_patch(size_t corner, size_t stride, double s, double t) const {
    const double across[3] = {(1 - s) * (1 - s), 2 * s * (1 - s), s * s}, down[3] = {(1 - t) * (1 - t), 2 * t * (1 - t), t * t};
    world_vertex sum{};
    for (size_t j = 0; j < 3; ++j)
      for (size_t i = 0; i < 3; ++i) {
        const world_vertex p = at(corner + j * stride + i);
        const double weight = across[i] * down[j];
        for (size_t n = 0; n < 3; ++n) sum.position[n] += weight * p.position[n];
        sum.u += weight * p.u;
        sum.v += weight * p.v;
      }
    return sum;
  }
};

// Entities are text: { "key" "value" ... } ...
std::vector<std::string_view> quoted(std::string_view text) {
  std::vector<std::string_view> all;
  for (size_t open = text.find('"'); open != text.npos;) {
    const size_t close = text.find('"', open + 1);
    if (close == text.npos) break;
    all.push_back(text.substr(open + 1, close - open - 1));
    open = text.find('"', close + 1);
  }
  return all;
}

struct entity { std::string_view kind; std::optional<vector3d> origin; };

entity entity_of(std::string_view text) {
  entity e;
  const std::vector<std::string_view> words = quoted(text);
  for (size_t k = 0; k + 1 < words.size(); k += 2) {
    double x = 0, y = 0, z = 0;
    if (words[k] == "classname") e.kind = words[k + 1];
    if (words[k] == "origin" && sscanf(std::string(words[k + 1]).c_str(), "%lf %lf %lf", &x, &y, &z) == 3 && std::isfinite(x + y + z)) e.origin = y_up(x, y, z);
  }
  return e;
}

std::vector<vector3d> places_of(std::string_view text) {
  constexpr double eye_height = 26;  // above a player's origin
  std::vector<vector3d> starts, things;
  for (size_t open = text.find('{'); open != text.npos; open = text.find('{', open + 1)) {
    const entity e = entity_of(text.substr(open, text.find('}', open) - open));
    if (!e.origin) continue;
    const bool thing = e.kind.starts_with("item_") || e.kind.starts_with("weapon_") || e.kind.starts_with("ammo_");
    if (!thing && !e.kind.starts_with("info_player")) continue;
    (thing ? things : starts).push_back({(*e.origin)[0], (*e.origin)[1] + eye_height, (*e.origin)[2]});
  }
  starts.insert(starts.end(), things.begin(), things.end());
  return starts;
}

// Pictures that are files of their own are added to `read`.
std::optional<image> picture_of(const search_path& files, const std::string& texture, std::vector<std::string>& read) {
  for (const char* const end : {"", ".tga", ".jpg", ".jpeg", ".png"})
    if (const std::optional<found_file> f = files.read(texture + end)) {
      if (f->is_loose) read.push_back(f->name);
      return decode_image(f->data.data(), f->data.size(), f->name);
    }
  return {};
}

texture_map map_of(const search_path& files, const std::string& texture, const model_options& o, level& l) {
  constexpr rgba8 grey{128, 128, 128, 255};
  std::optional<image> picture = picture_of(files, texture, l.drawn.files);
  if (!picture) l.missing.push_back(texture);
  image top = picture ? std::move(*picture) : image(1, 1, grey);
  for (rgba8& c : top.pixels) c.a = 255;
  return {std::move(top), o.levels, o.wrap_u.value_or(wrap::repeat), o.wrap_v.value_or(wrap::repeat), o.format, o.colours};
}

std::string texture_name(const lump& textures, size_t k) {
  const char* const text = reinterpret_cast<const char*>(textures.data + k * textures.record_bytes);
  std::string name(text, std::find(text, text + texture_name_bytes, '\0'));
  std::replace(name.begin(), name.end(), '\\', '/');
  std::replace_if(name.begin(), name.end(), [](unsigned char c) { return c < ' '; }, '?');
  return name;
}

// The files of an archive's maps by their names in small letters, of several of one name the first.
using archive_maps = std::map<std::string, std::string>;

std::string names_of(const archive_maps& maps) {
  std::string text;
  for (const auto& [name, file] : maps) text += (text.empty() ? "" : ", ") + fs::path(file).stem().string();
  return text;
}

bytes map_in(const archive& a, const std::string& wanted) {
  archive_maps maps;
  for (const std::string& file : a.names())
    if (lower(fs::path(file).extension().string()) == ".bsp") maps.try_emplace(lower(fs::path(file).stem().string()), file);
  if (maps.empty()) throw input_error(a.path() + ": no map (.bsp) in the archive");
  if (wanted.empty() && maps.size() > 1) throw input_error(a.path() + ": many maps, choose one by --map: " + names_of(maps));
  const auto found = wanted.empty() ? maps.begin() : maps.find(lower(wanted));
  if (found == maps.end()) throw input_error(a.path() + ": no map '" + wanted + "'; there are " + names_of(maps));
  return *a.read(found->second);
}

level read_level(const std::string& name, const bytes& file, const search_path& files, const model_options& options) {
  const bsp map(name, file);
  face_reader reader{map};
  reader.read();
  const lump text = map.part(entities_lump, 1);
  level l{{name, nullptr, std::move(reader.out), {}, 0}, places_of({reinterpret_cast<const char*>(text.data), text.count}), {}};
  std::map<std::string, int> index_of;  // names stand twice where their flags differ
  map_list maps;
  std::vector<world_face> faces;
  faces.reserve(l.drawn.faces.size());
  for (world_face& f : l.drawn.faces) {
    const std::string texture = texture_name(reader.textures, size_t(f.map_index));
    const auto [found, is_new] = index_of.try_emplace(texture, int(maps.size()));
    if (is_new) maps.push_back(map_of(files, texture, options, l));
    f.map_index = found->second;
    const texture_view& texels = maps[size_t(f.map_index)].view_on_demand();
    add_in_texels(faces, std::move(f), texels, name);
  }
  l.drawn.faces = std::move(faces);
  l.drawn.maps = std::make_shared<const map_list>(std::move(maps));
  const std::vector<std::string> archives = files.archives();
  l.drawn.files.insert(l.drawn.files.end(), archives.begin(), archives.end());
  l.drawn.measure();
  if (!l.drawn.has_area()) throw input_error(name + ": nothing to draw: no face has an area");
  return l;
}

}  // namespace

bool is_level(const std::string& path) { return lower(path).ends_with(".bsp") || lower(path).ends_with(".pk3"); }

level load_level(const std::string& path, const std::string& map, const model_options& options) {
  fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  if (lower(path).ends_with(".pk3")) {
    archive own(path);
    const bytes file = map_in(own, map);
    search_path files(folder.string());
    files.prefer(std::move(own));
    return read_level(map.empty() ? path : path + ": " + map, file, files, options);
  }
  if (!map.empty()) throw input_error("--map: " + path + " is one map; only an archive has many");
  if (folder.filename() == "maps") folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  level l = read_level(path, read_file(path), search_path(folder.string()), options);
  l.drawn.files.push_back(path);
  return l;
}

}  // namespace spantex::sim
