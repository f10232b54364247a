// SPDX-License-Identifier: Apache-2.0
#include "bench_frames.hpp"

#include <math.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <utility>

#include <sim/quality.hpp>

namespace spantex::tool {
namespace {

constexpr rgba8 background{0, 0, 0, 255};
constexpr int draws_of_a_turn = 3;  // the middle one counts: the first finds the caches as the others left them

double ms_since(std::chrono::steady_clock::time_point begun) { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count(); }

class contestant {
 public:
  explicit contestant(frames_row of) : row_(std::move(of)) {}
  virtual ~contestant() = default;
  virtual void begin_frame(const sim::camera_options& camera) = 0;
  virtual const sim::image& draw(double& set_up_ms, double& all_ms) = 0;

  void take_turn() {
    std::vector<double> set_up(draws_of_a_turn), all(draws_of_a_turn);
    for (size_t k = 0; k < draws_of_a_turn; ++k) picture_ = &draw(set_up[k], all[k]);
    set_up_.push_back(spread_of(set_up).median);
    all_.push_back(spread_of(all).median);
  }
  // What the turns of a frame came to.
  void end_frame(const sim::ideal_image& reference, const sim::image& ours, double flat_db) {
    set_up_of_frames_.push_back(spread_of(std::exchange(set_up_, {})).median);
    all_of_frames_.push_back(spread_of(std::exchange(all_, {})).median);
    squares_ += square_of(sim::psnr_db(picture(), reference));
    squares_to_ours_ += square_of(sim::psnr_db(picture(), ours));
    squares_of_flat_ += square_of(flat_db);
  }
  const sim::image& picture() const { return *picture_; }
  frames_row row() const {
    frames_row r = row_;
    r.set_up_ms = spread_of(set_up_of_frames_);
    r.all_ms = spread_of(all_of_frames_);
    r.most_ms = *std::max_element(all_of_frames_.begin(), all_of_frames_.end());
    const double frames = double(all_of_frames_.size());
    r.psnr_db = -10 * log10(squares_ / frames);
    r.psnr_ours_db = -10 * log10(squares_to_ours_ / frames);
    r.right_picture = squares_ < squares_of_flat_;
    return r;
  }

 private:
  static double square_of(double psnr_db) { return pow(10, -psnr_db / 10); }

  frames_row row_;
  const sim::image* picture_ = nullptr;
  std::vector<double> set_up_, all_, set_up_of_frames_, all_of_frames_;
  double squares_ = 0, squares_to_ours_ = 0, squares_of_flat_ = 0;
};

class our_contestant final : public contestant {
 public:
  our_contestant(const subject_options::loaded& subject, filter kind, kernels::choice kernel, frames_row of) : contestant(std::move(of)), subject_(subject) {
    options_.kind = kind;
    options_.kernel = kernel;
    options_.background = background;
  }
  void begin_frame(const sim::camera_options& camera) override { camera_ = camera; }
  const sim::image& draw(double& set_up_ms, double& all_ms) override {
    const auto begun = std::chrono::steady_clock::now();
    const sim::scene s = subject_.set_up(camera_);
    set_up_ms = ms_since(begun);
    result_ = sim::draw(s, options_);
    all_ms = set_up_ms + result_.ns_per_pixel * double(result_.picture.pixels.size()) / 1e6;
    return result_.picture;
  }

 private:
  const subject_options::loaded& subject_;
  sim::camera_options camera_;
  sim::draw_options options_;
  sim::draw_result result_;
};

class peer_contestant final : public contestant {
 public:
  peer_contestant(peers::peer& p, const sim::world& shape, sim::screen_size size, filter kind, frames_row of) : contestant(std::move(of)), peer_(p), shape_(shape), size_(size), kind_(kind) {}
  // Made ready anew: by another filter it may have drawn between.
  void begin_frame(const sim::camera_options& camera) override {
    prepare_peer(peer_, shape_, size_, kind_);
    clip_ = sim::clip_matrix(shape_, camera, size_);
  }
  const sim::image& draw(double&, double& all_ms) override {
    peer_.begin_frame(clip_.data());
    const auto begun = std::chrono::steady_clock::now();
    peer_.draw();
    all_ms = ms_since(begun);
    picture_ = picture_of(peer_, size_);
    return picture_;
  }

 private:
  peers::peer& peer_;
  const sim::world& shape_;
  sim::screen_size size_;
  filter kind_;
  std::array<double, 16> clip_;
  sim::image picture_;
};

// Those who draw by a filter; first ours.
struct contest {
  std::vector<std::unique_ptr<contestant>> all;
  size_t ours = 0;
};

contest contestants(const subject_options::loaded& subject, filter kind, const frames_choice& choice, const peer_list& peers) {
  contest c;
  const std::string filter_name(sim::name_of(sim::filter_names, kind));
  for (const kernels::choice kernel : choice.kernels) {
    const std::string kernel_name(sim::name_of(sim::kernel_names, kernel));
    if (kernel == kernels::choice::scalar || (kernels::kernel_of(kernel) != nullptr && kernels::draws(kind)))
      c.all.push_back(std::make_unique<our_contestant>(subject, kind, kernel, frames_row{filter_name, "spantex", kernel_name, {}, {}}));
  }
  c.ours = c.all.size();
  for (const auto& p : peers)
    if (prepare_peer(*p, subject.world(), subject.size(), kind))
      c.all.push_back(std::make_unique<peer_contestant>(*p, subject.world(), subject.size(), kind, frames_row{filter_name, p->name(), "", {}, {}}));
  return c;
}

}  // namespace

std::vector<frames_row> measure_frames(const subject_options::loaded& subject, const frames_choice& choice, const peer_list& peers, const std::function<void()>& step) {
  using faces = subject_options::loaded::faces;
  std::vector<sim::camera_options> cameras;
  if (subject.walks())
    for (const sim::viewpoint& v : subject.walk(choice.frames)) cameras.push_back(subject.camera_from(v));
  else
    for (int k = 0; k < choice.frames; ++k) cameras.push_back(subject.camera_at(360.0 * k / choice.frames));
  std::vector<contest> contests;
  for (const filter kind : choice.filters)
    if (contest c = contestants(subject, kind, choice, peers); c.ours != 0) contests.push_back(std::move(c));
  for (const sim::camera_options& camera : cameras) {
    const sim::ideal_image reference = sim::render_reference(subject.set_up(camera, nullptr, faces::all), background, sim::hardware_threads());
    const double flat_db = sim::flat_psnr_db(reference);
    for (contest& c : contests) {
      for (const auto& one : c.all) one->begin_frame(camera);
      for (int round = 0; round < choice.rounds; ++round)
        for (const auto& one : c.all) one->take_turn();
      for (size_t k = 0; k < c.all.size(); ++k) {
        if (k < c.ours && c.all[k]->picture().pixels != c.all[0]->picture().pixels) throw std::logic_error(subject.world().name + ": kernels differ");
        c.all[k]->end_frame(reference, c.all[0]->picture(), flat_db);
      }
      step();
    }
  }
  std::vector<frames_row> rows;
  for (const contest& c : contests)
    for (size_t k = 0; k < c.all.size(); ++k) {
      rows.push_back(c.all[k]->row());
      if (k < c.ours) rows.back().psnr_ours_db = NAN;
    }
  return rows;
}

}  // namespace spantex::tool
