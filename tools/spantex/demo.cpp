// SPDX-License-Identifier: Apache-2.0
// spantex demo: the three planes with a photographed map, KT88's figures, GCK09's chessboard and two models with their own textures, and one table:
// quality against the reference, and the cost on the simulated engine. Words, stalls and bank conflicts are engine sim's; the time is
// engine direct's, median of three, on this machine. Both engines must give the same bytes.
#include <stdio.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <sim/figures.hpp>
#include <sim/model.hpp>
#include <sim/quality.hpp>
#include <sim/screen_filter.hpp>
#include "commands.hpp"
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

void need(const std::string& path, const char* package) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw sim::input_error(path + ": missing; it is part of the Debian package " + package);
}

std::vector<sim::scene> scenes(const demo_options& o) {
  std::vector<sim::scene> all;
  sim::scene_request request;
  request.texture = sim::load_image(o.texture);
  for (const std::string& name : sim::scene_names()) all.push_back(sim::make_named_scene(name, request));
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
    return all;
  }
  if (s.name == "contour") return {{filter::contour, exact}, {filter::contour, standard}, {filter::contour, seed}};
  if (s.name == "chessboard") return {{filter::trilinear, exact}, {filter::aniso, standard}, {filter::step, standard}, {filter::hat, standard}};
  return {{filter::aniso, standard}, {filter::trilinear, exact}, {filter::trilinear3, standard}, {filter::trilinear, seed}};
}

// GCK09's four pictures: both filters on the screen and on the map, against a box of 48x48 samples of the board.
void chessboard(const sim::scene& s, const std::string& folder) {
  const auto board = [](double u, double v) { return sim::chessboard_at(u, v, sim::chessboard_texels); };
  const auto convolved = [&](sim::screen_kernel kernel, int samples) {
    return sim::filter_on_screen(s.items[0].ideal, s.size, board, kernel, sim::kernel_plane::screen, samples, background, sim::hardware_threads());
  };
  const sim::ideal_image judge = convolved(sim::screen_kernel::step, 48);
  printf("\nchessboard, PSNR dB against 48x48 samples of the board   on the screen   on the map\n");
  for (const auto& [kernel, kind] : {std::pair{sim::screen_kernel::step, filter::step}, {sim::screen_kernel::hat, filter::hat}}) {
    const sim::image original = sim::rounded(convolved(kernel, 32));
    sim::draw_options how;
    how.kind = kind;
    how.background = background;
    const std::string name(sim::name_of(sim::filter_names, kind));
    printf("  %-52s %13.2f %12.2f\n", name.c_str(), sim::psnr_db(original, judge), sim::psnr_db(sim::draw(s, how).picture, judge));
    sim::output_file(folder + "/chessboard-" + name + "-screen.png").write(sim::encode_png(original));
  }
}

void run(const demo_options& o) {
  need(o.texture, "python3-skimage");
  need(o.models, "assimp-testmodels");
  std::error_code error;
  std::filesystem::create_directories(o.out, error);
  if (error) throw sim::input_error(o.out + ": cannot make folder: " + error.message());
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
        sim::output_file(o.out + "/" + s.name + "-" + name_of(m) + ".png").write(sim::encode_png(rows.back().picture));
        rows.back().picture = {};
        bar.advance(1);
      }
    }
  }
  printf("%s\n", table_heading().c_str());
  for (const judged& r : rows) printf("%s\n", table_line(r).c_str());
  for (const sim::scene& s : all)
    if (s.name == "chessboard") chessboard(s, o.out);
}

}  // namespace

void add_demo_command(CLI::App& app) {
  const auto o = std::make_shared<demo_options>();
  CLI::App& sub = *app.add_subcommand("demo", "draw the demonstration pictures and print one table");
  sub.add_option("--out", o->out, "folder for the pictures; made if missing")->required();
  sub.add_option("--texture", o->texture, "map of the three planes")->capture_default_str();
  sub.add_option("--models", o->models, "folder of assimp's test models")->capture_default_str();
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
