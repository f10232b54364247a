// SPDX-License-Identifier: Apache-2.0
// The subcommands. Each adds itself to the application; its work runs when the command line has been parsed. Failures throw
// sim::input_error.
#pragma once
#include <optional>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include <sim/draw_host.hpp>

namespace spantex::tool {

void add_plane_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_texture_command(CLI::App& app);
void add_prefilters_command(CLI::App& app);
void add_trace_command(CLI::App& app);
void add_stress_command(CLI::App& app);
void add_chessboard_command(CLI::App& app);
void add_demo_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_bench_rig_command(CLI::App& app);
void add_sweep_command(CLI::App& app);

// GCK09's four pictures of a scene of the chessboard into the folder, and their table; profile and background of `how` count.
void chessboard_experiment(const sim::scene& s, sim::draw_options how, const std::string& folder);

// Equal pictures have no finite PSNR: null in JSON.
nlohmann::ordered_json finite_or_null(double x);

// What --stats writes. `textures_missing`: of a level (level.hpp).
std::string stats_help(const std::string& what);
nlohmann::ordered_json work_json(const sim::draw_result& r);  // what was done and skipped, of the whole picture
std::string stats_json(const sim::draw_result& r, const sim::draw_options& o, std::optional<double> psnr_db,
                       const std::vector<std::string>* textures_missing = nullptr);

// Draws with a progress bar.
sim::draw_result draw_with_bar(const sim::scene& s, sim::draw_options o, sim::frame_before* before = nullptr);
// PSNR against the reference, with a progress bar.
double reference_psnr_db(const sim::scene& s, const sim::image& picture, rgba8 background);

}  // namespace spantex::tool
