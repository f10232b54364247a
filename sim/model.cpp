// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <math.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <tuple>
#include <utility>

namespace spantex::sim {
namespace {

namespace fs = std::filesystem;

std::string one_line(std::string s) {
  std::replace_if(s.begin(), s.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return s;
}

// The entry of a folder with this name, whatever its case; empty if there is none.
fs::path entry_of(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  if (name == "." || name == ".." || fs::exists(folder / name, ignored)) return folder / name;
  for (const fs::directory_entry& e : fs::directory_iterator(folder, ignored))
    if (lower(e.path().filename().string()) == lower(name)) return e.path();
  return {};
}

fs::path below(fs::path at, const fs::path& relative) {
  for (const fs::path& part : relative) {
    if (part.empty()) continue;
    at = entry_of(at, part.string());
    if (at.empty()) return {};
  }
  return at;
}

fs::path find_texture(const fs::path& model, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path wanted(name), folder = model.parent_path().empty() ? fs::path(".") : model.parent_path();
  std::error_code ignored;
  if (wanted.is_absolute() && fs::is_regular_file(wanted, ignored)) return wanted;
  for (const fs::path& candidate : {below(folder, wanted.relative_path()), below(folder, wanted.filename())})
    if (!candidate.empty() && fs::is_regular_file(candidate, ignored)) return candidate;
  throw input_error(model.string() + ": texture '" + one_line(name) + "' not found");
}

image embedded_picture(const aiTexture& t, const std::string& name) {
  if (t.mHeight == 0) return decode_image(reinterpret_cast<const uint8_t*>(t.pcData), t.mWidth, name);
  if (t.mWidth > unsigned(max_picture_side) || t.mHeight > unsigned(max_picture_side) || t.mWidth == 0)
    throw input_error(name + ": embedded picture has a side outside 1.." + std::to_string(max_picture_side));
  image out(int(t.mWidth), int(t.mHeight), {});
  for (size_t k = 0; k < out.pixels.size(); ++k) out.pixels[k] = {t.pcData[k].r, t.pcData[k].g, t.pcData[k].b, t.pcData[k].a};
  return out;
}

wrap to_wrap(int mode) {
  switch (mode) {
    case aiTextureMapMode_Clamp: case aiTextureMapMode_Decal: return wrap::clamp;
    case aiTextureMapMode_Mirror: return wrap::mirror;
    default: return wrap::repeat;
  }
}

texture_map colour_map(const aiMaterial& material, const model_options& o) {
  aiColor4D c(0.8f, 0.8f, 0.8f, 1);
  aiGetMaterialColor(&material, AI_MATKEY_COLOR_DIFFUSE, &c);
  const auto byte = [](float x) { return uint8_t(lround(255 * std::clamp(double(x), 0.0, 1.0))); };
  return {image(1, 1, {byte(c.r), byte(c.g), byte(c.b), 255}), prefilter::box, wrap::repeat, wrap::repeat, o.format, o.colours};
}

texture_map material_map(const aiScene& file, const aiMaterial& material, const std::string& path, const model_options& o, std::vector<std::string>& files) {
  for (const aiTextureType type : {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR}) {
    aiString name;
    if (material.GetTexture(type, 0, &name) != aiReturn_SUCCESS) continue;
    const aiTexture* embedded = file.GetEmbeddedTexture(name.C_Str());
    image picture = embedded != nullptr ? embedded_picture(*embedded, path + ": texture '" + one_line(name.C_Str()) + "'")
                                        : load_image(files.emplace_back(find_texture(path, name.C_Str()).string()));
    for (rgba8& c : picture.pixels) c.a = 255;
    int u = aiTextureMapMode_Wrap, v = aiTextureMapMode_Wrap;
    aiGetMaterialInteger(&material, AI_MATKEY_MAPPINGMODE_U(type, 0), &u);
    aiGetMaterialInteger(&material, AI_MATKEY_MAPPINGMODE_V(type, 0), &v);
    return {std::move(picture), o.levels, o.wrap_u.value_or(to_wrap(u)), o.wrap_v.value_or(to_wrap(v)), o.format, o.colours, o.most_levels, o.making};
  }
  return colour_map(material, o);
}

// Whole periods taken off, so that coordinates stay small; clamped maps stay as they are.
double periods_off(double least, wrap mode) {
  if (mode == wrap::repeat) return floor(least);
  return mode == wrap::mirror ? 2 * floor(least / 2) : 0;
}

world_face to_face(const aiMesh& mesh, const aiFace& f, const std::string& path) {
  world_face out{{}, int(mesh.mMaterialIndex)};
  for (unsigned k = 0; k < f.mNumIndices; ++k) {
    const aiVector3D& p = mesh.mVertices[f.mIndices[k]];
    const aiVector3D uv = mesh.HasTextureCoords(0) ? mesh.mTextureCoords[0][f.mIndices[k]] : aiVector3D();
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) throw input_error(path + ": a vertex is not a finite number");
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) throw input_error(path + ": a texture coordinate is not a finite number");
    out.corners.push_back({{p.x, p.y, p.z}, uv.x, 1.0 - double(uv.y)});
  }
  return out;
}

// Assimp only logs a material library that it cannot open, and goes on in gray. It looks beside the model for the name to the line's end,
// then for the model's own name with .mtl.
void check_material_libraries(const std::string& path, std::string_view text) {
  if (lower(fs::path(path).extension().string()) != ".obj") return;
  constexpr std::string_view blanks = " \t\r", keyword = "mtllib";
  std::error_code ignored;
  if (fs::exists(fs::path(path).replace_extension("mtl"), ignored)) return;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    if (!line.starts_with(keyword) || line.size() == keyword.size() || blanks.find(line[keyword.size()]) == line.npos) continue;
    line.remove_prefix(std::min(line.find_first_not_of(blanks, keyword.size()), line.size()));
    std::string name(line.substr(0, line.find_last_not_of(blanks) + 1));
    std::replace(name.begin(), name.end(), '\\', '/');
    if (!name.empty() && !fs::exists(fs::path(path).parent_path() / name, ignored))
      throw input_error(path + ": material library '" + one_line(name) + "' not found");
  }
}

// Before meshes are joined, so that they still have their names.
void check_coordinates(const aiScene& file, const std::string& path) {
  bool any = false, any_face = false;
  for (unsigned k = 0; k < file.mNumMeshes; ++k) {
    const aiMesh& mesh = *file.mMeshes[k];
    if ((mesh.mPrimitiveTypes & (aiPrimitiveType_TRIANGLE | aiPrimitiveType_POLYGON)) == 0) continue;
    const aiMaterial& material = *file.mMaterials[mesh.mMaterialIndex];
    const bool textured = material.GetTextureCount(aiTextureType_DIFFUSE) + material.GetTextureCount(aiTextureType_BASE_COLOR) > 0;
    if (textured && !mesh.HasTextureCoords(0))
      throw input_error(path + ": mesh " + std::to_string(k) + " '" + one_line(mesh.mName.C_Str()) +
                        "' has a texture but no texture coordinates");
    any_face = true;
    any |= mesh.HasTextureCoords(0);
  }
  if (!any_face) throw input_error(path + ": model has no faces");
  if (!any) throw input_error(path + ": model has no texture coordinates");
}

const aiScene& processed(Assimp::Importer& importer, const aiScene* file, const std::string& path) {
  if (file != nullptr) return *file;
  throw input_error(path + ": cannot read model: " + one_line(importer.GetErrorString()));
}

constexpr double most_texels = 32768, most_parts = 1024;  // of a face
constexpr size_t most_cut_faces = size_t(1) << 20;        // of a world, 1.5 GB

using coordinate_of = double world_vertex::*;

// The parts of a face on either side of a line of its map.
std::array<world_face, 2> cut(const world_face& face, coordinate_of axis, double at) {
  std::array<world_face, 2> sides{world_face{{}, face.map_index}, world_face{{}, face.map_index}};
  for (size_t k = 0; k < face.corners.size(); ++k) {
    const world_vertex &a = face.corners[k], &b = face.corners[(k + 1) % face.corners.size()];
    if (a.*axis <= at) sides[0].corners.push_back(a);
    if (a.*axis >= at) sides[1].corners.push_back(a);
    if ((a.*axis < at) == (b.*axis < at) || a.*axis == at || b.*axis == at) continue;
    const auto& [low, high] = a.*axis < b.*axis ? std::tie(a, b) : std::tie(b, a);  // the same point from either end
    const double t = (at - low.*axis) / (high.*axis - low.*axis);
    world_vertex between{low.position + (high.position - low.position) * t, low.u + (high.u - low.u) * t, low.v + (high.v - low.v) * t};
    between.*axis = at;
    for (world_face& side : sides) side.corners.push_back(between);
  }
  return sides;
}

// A coordinate of a face's corners, in widths or heights of the map, whole periods taken off, and what they are multiplied by.
struct map_axis {
  coordinate_of of;
  wrap mode;
  double side, least = INFINITY, most = -INFINITY, off = 0;

  void look_at(const world_face& face) {
    least = INFINITY, most = -INFINITY;
    for (const world_vertex& c : face.corners) {
      least = std::min(least, c.*of);
      most = std::max(most, c.*of);
    }
    off = periods_off(least, mode);
  }
  bool fits() const { return (most - off) * side < most_texels && (least - off) * side > -most_texels; }
  // Faces that do not fit are cut at multiples of this, the same for all of them, so that neighbours have the same corners: as many periods, of mirrored maps too, as fit.
  double step() const { return 2 * floor((most_texels - 1) / side / 2); }
  double parts() const { return floor(most / step()) - floor(least / step()) + 1; }
};

}  // namespace

void add_in_texels(std::vector<world_face>& to, world_face whole, const texture_view& t, const std::string& path) {
  map_axis axes[] = {{&world_vertex::u, t.wrap_u(), double(t.width())}, {&world_vertex::v, t.wrap_v(), double(t.height())}};
  double parts = 1;
  for (map_axis& axis : axes) {
    axis.look_at(whole);
    if (axis.fits()) continue;
    parts *= axis.parts();
    if (axis.mode == wrap::clamp || !(parts <= most_parts)) throw input_error(path + ": texture coordinates of a face exceed 32768 texels");
  }
  if (parts > 1 && to.size() + size_t(parts) > most_cut_faces) throw input_error(path + ": more than 2^20 faces, cut where their texture coordinates exceed 32768 texels");
  std::vector<world_face> pieces{std::move(whole)};
  for (const map_axis& axis : axes) {
    if (axis.fits()) continue;
    std::vector<world_face> strips;
    for (world_face& rest : pieces) {
      map_axis own = axis;
      own.look_at(rest);
      for (double n = floor(own.least / own.step()) + 1; n * own.step() < own.most; ++n) {
        auto [strip, next] = cut(rest, own.of, n * own.step());
        strips.push_back(std::move(strip));
        rest = std::move(next);
      }
      strips.push_back(std::move(rest));
    }
    pieces = std::move(strips);
  }
  for (world_face& face : pieces) {
    for (map_axis& axis : axes) {
      axis.look_at(face);
      for (world_vertex& c : face.corners) c.*axis.of = (c.*axis.of - axis.off) * axis.side;
    }
    to.push_back(std::move(face));
  }
}

world load_model(const std::string& path, const model_options& options) {
  const bytes text = read_file(path);  // says why, where assimp would only say that it cannot
  check_material_libraries(path, {reinterpret_cast<const char*>(text.data()), text.size()});
  Assimp::Importer importer;
  check_coordinates(processed(importer, importer.ReadFile(path, aiProcess_GenUVCoords | aiProcess_TransformUVCoords), path), path);
  const unsigned flat = aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType;
  const aiScene* const file = &processed(importer, importer.ApplyPostProcessing(flat), path);
  world w{path, nullptr, {}, {}, 0, {path}};
  map_list maps;
  for (unsigned k = 0; k < file->mNumMaterials; ++k) maps.push_back(material_map(*file, *file->mMaterials[k], path, options, w.files));
  for (unsigned k = 0; k < file->mNumMeshes; ++k) {
    const aiMesh& mesh = *file->mMeshes[k];
    if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
    for (unsigned n = 0; n < mesh.mNumFaces; ++n)
      add_in_texels(w.faces, to_face(mesh, mesh.mFaces[n], path), maps.at(mesh.mMaterialIndex).view_on_demand(), path);
  }
  w.maps = std::make_shared<const map_list>(std::move(maps));
  w.measure();
  if (!w.has_area()) throw input_error(path + ": nothing to draw: no face has an area");
  return w;
}

}  // namespace spantex::sim
