// SPDX-License-Identifier: Apache-2.0
// spantex demo: the three planes with a photographed map (tilted by every filter, with every prefilter and the inverse filter, from compressed maps,
// in linear light), KT88's figures, GCK09's chessboard, contours, surfaces with alpha and colours of vertices, and two models with their own
// textures, and one table: quality against the reference, and the cost on the simulated engine. Words, stalls and bank conflicts are engine
// sim's; the time is engine direct's, median of three, on this machine. Both engines must give the same bytes.
#include <stdio.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <sim/figures.hpp>
#include <sim/model.hpp>
#include <sim/pack.hpp>
#include <sim/quality.hpp>
#include "commands.hpp"
#include "demo_surfaces.hpp"
#include "methods.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace spantex::tool {
namespace {

using sim::profile_choice;

struct demo_options {
  std::string out;
  std::string texture = "/usr/lib/python3/dist-packages/skimage/data/brick.png";
  std::string models = "/usr/share/assimp/models";
};

constexpr rgba8 background{24, 28, 36, 255};

void need(const std::string& path, const std::string& usual, const std::string& package) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw sim::input_error(path + ": missing" + (path == usual ? "; it is part of the Debian package " + package : ""));
}

std::vector<sim::scene> scenes(const demo_options& o) {
  std::vector<sim::scene> all;
  sim::scene_request request;
  request.texture = sim::load_image(o.texture);
  for (const std::string& name : sim::scene_names()) all.push_back(sim::make_named_scene(name, request));
  // The tilted plane again, its map compressed, and its colours taken as sRGB.
  const auto add_variant = [&](const char* name, texel_format format, colour_space colours) {
    sim::scene_request variant = request;
    variant.format = format;
    variant.colours = colours;
    all.push_back(sim::make_named_scene("tilted", variant));
    all.back().name = name;
  };
  add_variant("tilted-bc1", texel_format::bc1, colour_space::coded);
  add_variant("tilted-etc2", texel_format::etc2_rgb8, colour_space::coded);
  add_variant("tilted-srgb", texel_format::rgba8888, colour_space::srgb);
  // And with levels by other prefilters, and sharpened.
  const auto add_levels = [&](const char* name, sim::prefilter kind, bool inverse) {
    sim::compile_options levels;
    levels.levels = kind;
    levels.inverse = inverse;
    sim::map_list maps;
    maps.emplace_back(sim::compile_pack(*request.texture, levels), name);
    sim::scene_request variant = request;
    variant.maps = std::make_shared<const sim::map_list>(std::move(maps));
    all.push_back(sim::make_named_scene("tilted", variant));
    all.back().name = name;
  };
  add_levels("tilted-triangle", sim::prefilter::triangle, false);
  add_levels("tilted-kaiser", sim::prefilter::kaiser, false);
  add_levels("tilted-lanczos", sim::prefilter::lanczos, false);
  add_levels("tilted-inverse", sim::prefilter::box, true);
  const auto add_model = [&](const char* name, const std::string& file, double yaw, double pitch) {
    sim::camera_options camera;
    camera.yaw_degrees = yaw;
    camera.pitch_degrees = pitch;
    all.push_back(sim::look_at(sim::load_model(o.models + "/" + file, {}), camera, request.size));
    all.back().name = name;
  };
  add_model("spider", "OBJ/spider.obj", 35, 30);
  add_model("duck", "Collada/duck.dae", 25, 15);
  return all;
}

std::vector<method> methods_of(const sim::scene& s) {
  using enum profile_choice;
  std::vector<method> all;
  if (sim::named_plane(s.name)) {
    for (const filter kind : {filter::bilinear, filter::trilinear, filter::aniso})
      for (const profile_choice p : {exact, standard, compact, seed}) all.push_back({kind, p});
    all.push_back({filter::squares, standard});
    all.push_back({filter::trilinear, standard, sim::sampling_space::object});
    if (s.name != "tilted") return all;
    for (const filter kind : {filter::nearest, filter::three_point, filter::mip_bilinear, filter::trilinear3, filter::step, filter::hat}) all.push_back({kind, standard});
    for (const level_formula level : {level_formula::major, level_formula::minor})
      all.push_back({filter::trilinear, standard, sim::sampling_space::screen, {.level = level}});
    return all;
  }
  if (s.name == "contour") return {{filter::contour, exact}, {filter::contour, standard}, {filter::contour, seed}};
  if (s.name.starts_with("tilted-")) return {{filter::trilinear, standard}, {filter::aniso, standard}};
  if (s.name == "chessboard") return {{filter::trilinear, exact}, {filter::aniso, standard}, {filter::step, standard}, {filter::hat, standard}};
  return {{filter::aniso, standard}, {filter::trilinear, exact}, {filter::trilinear3, standard}, {filter::trilinear, seed}};
}

void run(const demo_options& o) {
  need(o.texture, demo_options().texture, "python3-skimage");
  need(o.models, demo_options().models, "assimp-testmodels");
  if (std::filesystem::path(sim::place_of(o.texture)).parent_path() == sim::place_of(o.out))
    throw sim::input_error("--texture: " + o.texture + " lies in the folder of --out, where a picture might replace it");
  make_folder(o.out);
  const std::vector<sim::scene> all = scenes(o);
  int total = 0;
  for (const sim::scene& s : all) total += int(methods_of(s).size()) + 1;
  std::vector<judged> rows;
  {
    progress_bar bar("demo", total);
    for (const sim::scene& s : all) {
      const bench on(s, background, 3);
      bar.advance(1);
      for (const method& m : methods_of(s)) {
        rows.push_back(on.judge(m));
        sim::output_file(o.out + "/" + s.name + "-" + file_name_of(m) + ".png").write(sim::encode_png(rows.back().picture));
        rows.back().picture = {};
        bar.advance(1);
      }
    }
  }
  printf("%s\n", table_heading().c_str());
  for (const judged& r : rows) printf("%s\n", table_line(r).c_str());
  sim::draw_options how;
  how.background = background;
  draw_surfaces(how, o.out);
  for (const sim::scene& s : all)
    if (s.name == "chessboard") chessboard_experiment(s, how, o.out);
}

}  // namespace

void add_demo_command(CLI::App& app) {
  const auto o = std::make_shared<demo_options>();
  CLI::App& sub = *app.add_subcommand("demo", "draw the demonstration pictures and print one table");
  sub.add_option("--out", o->out, "folder for the pictures; made if missing")->required();
  sub.add_option("--texture", o->texture, "map of the three planes, a picture")->capture_default_str();
  sub.add_option("--models", o->models, "folder of assimp's test models")->capture_default_str();
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
