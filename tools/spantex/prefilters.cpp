// SPDX-License-Identifier: Apache-2.0
// spantex prefilters: what each prefilter does to a map, with and without the inverse filter, measured.
#include <stdio.h>

#include <memory>

#include <sim/prefilter_figures.hpp>
#include <sim/quality.hpp>
#include <sim/reference.hpp>
#include "commands.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace spantex::tool {
namespace {

struct prefilters_options {
  std::string texture, profile = "default", filter = "trilinear";
  int level = 1;
};

struct variant { sim::prefilter kind; bool inverse; };

std::vector<variant> variants() {
  std::vector<variant> all;
  for (const bool inverse : {false, true})
    for (const auto& n : sim::prefilter_names) all.push_back({n.value, inverse});
  return all;
}

sim::compile_options options_of(const variant& v) {
  sim::compile_options c;
  c.levels = v.kind;
  c.inverse = v.inverse;
  c.threads = sim::hardware_threads();
  return c;
}

std::string label(const variant& v) { return std::string(sim::name_of(sim::prefilter_names, v.kind)) + (v.inverse ? " inverse" : ""); }

void print_responses(int level) {
  printf("response at level %d to gratings, cycles per texel of that level; overshoot of an edge of 128\n", level);
  printf("%-16s %7s %7s %7s %7s %7s | %7s %7s %7s | %s\n", "prefilter", "1/16", "1/8", "1/4", "3/8", "1/2", "5/8", "3/4", "7/8", "overshoot");
  for (const variant& v : variants()) {
    const sim::prefilter_figures f = sim::figures_of(options_of(v), level);
    printf("%-16s", label(v).c_str());
    for (const double r : f.response) printf(" %7.3f", r);
    printf(" |");
    for (const double r : f.aliased) printf(" %7.3f", r);
    printf(" | %d\n", f.overshoot);
  }
}

constexpr const char* planes[] = {"facing", "tilted", "grazing"};

sim::scene scene_of(const char* plane, const sim::image& picture, const variant& v) {
  sim::map_list maps;
  maps.emplace_back(sim::compile_pack(picture, options_of(v)), label(v));
  sim::scene_request request;
  request.maps = std::make_shared<const sim::map_list>(std::move(maps));
  return sim::make_named_scene(plane, request);
}

void print_planes(const prefilters_options& o, const sim::draw_options& drawing) {
  const sim::image picture = sim::load_image(o.texture);
  std::vector<std::vector<double>> psnr_db(variants().size());
  {
    progress_bar bar("planes", 3);
    for (const char* plane : planes) {
      const sim::ideal_image reference = sim::render_reference(scene_of(plane, picture, {}), drawing.background, sim::hardware_threads());
      for (size_t k = 0; k < variants().size(); ++k)
        psnr_db[k].push_back(sim::psnr_db(sim::draw(scene_of(plane, picture, variants()[k]), drawing).picture, reference));
      bar.advance(1);
    }
  }
  printf("\nPSNR in dB, 640x480, %s, profile %s, %s\n%-16s %8s %8s %8s\n", o.filter.c_str(), o.profile.c_str(), o.texture.c_str(), "prefilter", planes[0],
         planes[1], planes[2]);
  for (size_t k = 0; k < variants().size(); ++k)
    printf("%-16s %8.2f %8.2f %8.2f\n", label(variants()[k]).c_str(), psnr_db[k][0], psnr_db[k][1], psnr_db[k][2]);
}

void run(const prefilters_options& o) {
  constexpr int most_level = 4;
  sim::draw_options drawing;
  drawing.kind = value_of(sim::filter_names, o.filter, "filter");
  drawing.profile = value_of(sim::profile_names, o.profile, "profile");
  drawing.threads = sim::hardware_threads();
  check_range("--level", o.level, 1, most_level);
  if (!o.texture.empty()) sim::load_image(o.texture);
  print_responses(o.level);
  if (!o.texture.empty()) print_planes(o, drawing);
}

}  // namespace

void add_prefilters_command(CLI::App& app) {
  const auto o = std::make_shared<prefilters_options>();
  CLI::App& sub = *app.add_subcommand("prefilters", "measure the prefilters, with and without the inverse filter, and print tables");
  sub.add_option("--level", o->level, "the level measured, 1..4")->capture_default_str();
  sub.add_option("--texture", o->texture, "also the quality of the three planes with this picture as their map");
  sub.add_option("--filter", o->filter, "of the planes: " + list_of(sim::filter_names))->capture_default_str();
  sub.add_option("--profile", o->profile, "of the planes: " + list_of(sim::profile_names))->capture_default_str();
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
