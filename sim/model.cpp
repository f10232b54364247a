// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <math.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace spantex::sim {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return char(tolower(c)); });
  return s;
}

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

texture_map colour_map(const aiMaterial& material) {
  aiColor4D c(0.8f, 0.8f, 0.8f, 1);
  aiGetMaterialColor(&material, AI_MATKEY_COLOR_DIFFUSE, &c);
  const auto byte = [](float x) { return uint8_t(lround(255 * std::clamp(double(x), 0.0, 1.0))); };
  return {image(1, 1, {byte(c.r), byte(c.g), byte(c.b), 255}), prefilter::box, wrap::repeat, wrap::repeat};
}

texture_map material_map(const aiScene& file, const aiMaterial& material, const std::string& path, const model_options& o) {
  for (const aiTextureType type : {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR}) {
    aiString name;
    if (material.GetTexture(type, 0, &name) != aiReturn_SUCCESS) continue;
    const aiTexture* embedded = file.GetEmbeddedTexture(name.C_Str());
    image picture = embedded != nullptr ? embedded_picture(*embedded, path + ": texture '" + one_line(name.C_Str()) + "'")
                                        : load_image(find_texture(path, name.C_Str()).string());
    for (rgba8& c : picture.pixels) c.a = 255;
    int u = aiTextureMapMode_Wrap, v = aiTextureMapMode_Wrap;
    aiGetMaterialInteger(&material, AI_MATKEY_MAPPINGMODE_U(type, 0), &u);
    aiGetMaterialInteger(&material, AI_MATKEY_MAPPINGMODE_V(type, 0), &v);
    return {std::move(picture), o.levels, o.wrap_u.value_or(to_wrap(u)), o.wrap_v.value_or(to_wrap(v))};
  }
  return colour_map(material);
}

// Whole periods taken off, so that coordinates stay small; clamped maps stay as they are.
double periods_off(double least, wrap mode) {
  if (mode == wrap::repeat) return floor(least);
  return mode == wrap::mirror ? 2 * floor(least / 2) : 0;
}

world_face to_face(const aiMesh& mesh, const aiFace& f, const texture_map& map, const std::string& path) {
  const texture_view& t = map.view();
  world_face out{{}, int(mesh.mMaterialIndex)};
  double least_u = INFINITY, least_v = INFINITY;
  for (unsigned k = 0; k < f.mNumIndices; ++k) {
    const aiVector3D& p = mesh.mVertices[f.mIndices[k]];
    const aiVector3D uv = mesh.HasTextureCoords(0) ? mesh.mTextureCoords[0][f.mIndices[k]] : aiVector3D();
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) throw input_error(path + ": a vertex is not a finite number");
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) throw input_error(path + ": a texture coordinate is not a finite number");
    out.corners.push_back({{p.x, p.y, p.z}, uv.x, 1.0 - double(uv.y)});
    least_u = std::min(least_u, out.corners.back().u);
    least_v = std::min(least_v, out.corners.back().v);
  }
  for (world_vertex& c : out.corners) {
    c.u = (c.u - periods_off(least_u, t.wrap_u())) * t.width();
    c.v = (c.v - periods_off(least_v, t.wrap_v())) * t.height();
    if (!(fabs(c.u) < 32768 && fabs(c.v) < 32768)) throw input_error(path + ": texture coordinates of a face exceed 32768 texels");
  }
  return out;
}

}  // namespace

world load_model(const std::string& path, const model_options& options) {
  read_file(path);  // says why, where assimp would only say that it cannot
  Assimp::Importer importer;
  const aiScene* file = importer.ReadFile(path, aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType |
                                                    aiProcess_GenUVCoords | aiProcess_TransformUVCoords);
  if (file == nullptr) throw input_error(path + ": cannot read model: " + one_line(importer.GetErrorString()));
  world w{path, nullptr, {}, {}, 0};
  map_list maps;
  for (unsigned k = 0; k < file->mNumMaterials; ++k) maps.push_back(material_map(*file, *file->mMaterials[k], path, options));
  bool any_coordinates = false;
  for (unsigned k = 0; k < file->mNumMeshes; ++k) {
    const aiMesh& mesh = *file->mMeshes[k];
    if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
    any_coordinates |= mesh.HasTextureCoords(0) && mesh.mNumFaces > 0;
    for (unsigned n = 0; n < mesh.mNumFaces; ++n)
      w.faces.push_back(to_face(mesh, mesh.mFaces[n], maps.at(mesh.mMaterialIndex), path));
  }
  if (w.faces.empty()) throw input_error(path + ": model has no faces");
  if (!any_coordinates) throw input_error(path + ": model has no texture coordinates");
  w.maps = std::make_shared<const map_list>(std::move(maps));
  w.measure();
  return w;
}

}  // namespace spantex::sim
