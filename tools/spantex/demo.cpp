// SPDX-License-Identifier: Apache-2.0
// spantex demo: the three planes with a photographed map, KT88's figures and two models with their own textures, and one table:
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
#include <sim/reference.hpp>
#include "commands.hpp"
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

struct variant { filter kind; profile_choice profile; };

struct row {
  std::string picture;
  variant how;
  double psnr_db;
  sim::draw_result result;
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

std::vector<variant> variants_of(const sim::scene& s) {
  using enum profile_choice;
  std::vector<variant> all;
  if (sim::named_plane(s.name)) {
    for (const filter kind : {filter::bilinear, filter::trilinear})
      for (const profile_choice p : {exact, standard, compact, seed}) all.push_back({kind, p});
    return all;
  }
  return {{filter::trilinear, exact}, {filter::trilinear3, standard}, {filter::trilinear, seed}};
}

std::string label(const variant& v) {
  return std::string(sim::name_of(sim::filter_names, v.kind)) + "-" + std::string(sim::name_of(sim::profile_names, v.profile));
}

row measure(const sim::scene& s, const variant& v, const sim::ideal_image& reference) {
  sim::draw_options o;
  o.kind = v.kind;
  o.profile = v.profile;
  o.background = background;
  o.engine = sim::engine_choice::simulated;
  sim::draw_result r = sim::draw(s, o);
  o.engine = sim::engine_choice::direct;
  o.repeat = 3;
  const sim::draw_result direct = sim::draw(s, o);
  if (direct.picture.pixels != r.picture.pixels) throw std::runtime_error(s.name + " " + label(v) + ": engines direct and sim differ");
  r.ns_per_pixel = direct.ns_per_pixel;
  const double psnr_db = sim::psnr_db(r.picture, reference);
  return {s.name, v, psnr_db, std::move(r)};
}

void print_table(const std::vector<row>& rows) {
  printf("%-8s  %-10s  %-7s  %7s  %9s  %9s  %9s  %8s\n", "picture", "filter", "profile", "PSNR dB", "words", "stalls", "conflicts",
         "ns/pixel");
  const auto count = [](uint64_t n) { return static_cast<unsigned long long>(n); };
  for (const row& r : rows) {
    const std::string kind(sim::name_of(sim::filter_names, r.how.kind)), profile(sim::name_of(sim::profile_names, r.how.profile));
    const sim::counters& m = r.result.machine;
    printf("%-8s  %-10s  %-7s  %7.2f  %9llu  %9llu  %9llu  %8.1f\n", r.picture.c_str(), kind.c_str(), profile.c_str(), r.psnr_db,
           count(m.words_loaded), count(m.stall_cycles), count(m.bank_conflicts), r.result.ns_per_pixel);
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
  for (const sim::scene& s : all) total += int(variants_of(s).size()) + 1;
  std::vector<row> rows;
  {
    progress_bar bar("demo", total);
    for (const sim::scene& s : all) {
      const sim::ideal_image reference = sim::render_reference(s, background, sim::hardware_threads());
      bar.advance(1);
      for (const variant& v : variants_of(s)) {
        rows.push_back(measure(s, v, reference));
        sim::output_file(o.out + "/" + s.name + "-" + label(v) + ".png").write(sim::encode_png(rows.back().result.picture));
        rows.back().result.picture = {};
        bar.advance(1);
      }
    }
  }
  print_table(rows);
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
