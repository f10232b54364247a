// SPDX-License-Identifier: Apache-2.0
// Drawing and judging with a progress bar, and what is told about it as JSON.
#include <math.h>

#include <nlohmann/json.hpp>

#include <sim/quality.hpp>
#include <sim/reference.hpp>
#include "commands.hpp"
#include "progress.hpp"

namespace spantex::tool {

std::string stats_help(const std::string& what) {
  return what + "; engine sim with threads: 'machines' engines, 'cycles' of the one that took longest, 'cycles_of_all_machines' and all other counts summed over them";
}

nlohmann::ordered_json work_json(const sim::draw_result& r) {
  const draw_counters& w = r.work;
  const skip_counters& k = r.skipped;
  nlohmann::ordered_json j;
  j["spans_total"] = w.spans_total;
  j["spans_skipped"] = {{"empty", w.spans_empty}, {"behind", w.spans_behind}, {"hidden", w.spans_hidden}};
  j["jobs"] = w.jobs;
  j["corrected_jobs"] = w.corrected_jobs;
  j["pixels"] = w.pixels;
  j["words_loaded"] = w.words_loaded;
  j["words_read"] = w.words_read;
  j["blocks_decoded"] = r.blocks_decoded;
  j["loads_skipped"] = w.loads_skipped;
  j["divides"] = w.divides;
  j["evaluations"] = {{"constant", k.jobs_constant}, {"affine", w.affine_jobs}, {"series", w.series_jobs}, {"divide", w.divide_jobs}};
  j["second_levels_skipped"] = w.second_levels_skipped;
  j["pixels_left"] = w.pixels_left;
  j["pixels_blended"] = w.pixels_blended;
  // By the names of --no-skip, beside those that have counts of their own above; cull by --cull.
  j["skipped"] = {{"outside", {{"polygons", r.polygons_outside}, {"spans", k.spans_outside}}},
                  {"occluded", {{"polygons", r.polygons_hidden}}},
                  {"cull", {{"polygons", r.polygons_culled}}},
                  {"floors", {{"spans", k.spans_below_floor}}},
                  {"other-half", {{"jobs", k.loads_in_other_half}}},
                  {"constant", {{"spans", k.spans_constant}, {"pixels", k.pixels_constant}}},
                  {"uniform", {{"jobs", k.jobs_uniform}}},
                  {"one-texel", {{"jobs", k.jobs_one_texel}}},
                  {"copy", {{"jobs", k.jobs_copied}}},
                  {"opaque", {{"pixels", k.pixels_opaque}}},
                  {"transparent", {{"jobs", k.jobs_transparent}}},
                  {"levels", {{"levels", r.levels_left_out}}},
                  {"unchanged", {{"spans", r.spans_unchanged}}},
                  {"pixels_written", k.pixels_written}};
  return j;
}

nlohmann::ordered_json finite_or_null(double x) { return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(); }

std::string stats_json(const sim::draw_result& r, const sim::draw_options& o, std::optional<double> psnr_db, const std::vector<std::string>* textures_missing) {
  nlohmann::ordered_json j;
  j["profile"] = std::string(sim::name_of(sim::profile_names, o.profile));
  j["filter"] = std::string(sim::name_of(sim::filter_names, o.kind));
  j["engine"] = std::string(sim::name_of(sim::engine_names, o.engine));
  j["kernel"] = std::string(r.kernel);
  j["format"] = std::string(sim::name_of(sim::format_names, r.format));
  j["words_uploaded"] = r.words_uploaded;
  j["alpha"] = std::string(sim::name_of(sim::alpha_names, o.how.alpha));
  j["srgb"] = r.colours == colour_space::srgb;
  j["threads"] = o.threads;
  j["repeat"] = o.repeat;
  j["width"] = r.picture.width_px;
  j["height"] = r.picture.height_px;
  j["ns_per_pixel"] = r.ns_per_pixel;
  j.update(work_json(r));
  if (o.engine == sim::engine_choice::simulated) {
    const sim::counters& m = r.machine;
    j["machines"] = r.machines;
    j["cycles_of_all_machines"] = r.cycles_of_all_machines;
    j["cycles"] = m.total_cycles;
    j["stalls"] = m.stall_cycles;
    j["bank_conflicts"] = m.bank_conflicts;
    j["load_cycles"] = m.load_cycles;
    j["hidden_load_cycles"] = m.hidden_load_cycles;
    j["compute_cycles"] = m.compute_cycles;
    j["fetches"] = m.fetches;
    j["texel_reads"] = m.texel_reads;
  }
  if (psnr_db) j["psnr_db"] = finite_or_null(*psnr_db);
  if (textures_missing != nullptr) j["textures_missing"] = *textures_missing;
  return j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";  // a level's names are any bytes
}

sim::draw_result draw_with_bar(const sim::scene& s, sim::draw_options o, sim::frame_before* before) {
  const bool is_named = o.kernel != kernels::choice::scalar && o.kernel != kernels::choice::fastest;
  if (is_named && sim::kernel_for(o) != o.kernel)
    throw sim::input_error("--kernel " + std::string(sim::name_of(sim::kernel_names, o.kernel)) +
                           ": draws by the numbers of profile default with any --samples (pixels: and exact, with any of aniso's) on engine direct, filters nearest, bilinear, mip-bilinear, trilinear, aniso, no skip off; take fastest or scalar");
  progress_bar bar("drawing " + s.name, sim::draw_parts(s, o));
  o.parts_done = bar.callback();
  return sim::draw(s, o, before);
}

double reference_psnr_db(const sim::scene& s, const sim::image& picture, rgba8 background) {
  progress_bar bar("reference of " + s.name, s.size.height_px);
  return sim::psnr_db(picture, sim::render_reference(s, background, sim::hardware_threads(), bar.callback()));
}

}  // namespace spantex::tool
