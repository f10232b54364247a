// SPDX-License-Identifier: Apache-2.0
#include "bench_measure.hpp"

#include <math.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include <sim/quality.hpp>

namespace spantex::tool {
namespace {

constexpr rgba8 background{0, 0, 0, 255};

// A turn of somebody fast is a few draws, its middle one counts: the first ones find the caches as the others left them.
constexpr int draws_of_a_turn = 5, fewest_samples = 3;
constexpr double slow_ns = 20e6;  // a draw: from here on a turn is one draw, and there are few

double now_ns() { return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class contestant {
 public:
  virtual ~contestant() = default;
  virtual double draw(int times) = 0;  // ns a picture, the middle one of so many
  virtual sim::image picture() const = 0;

  // The first turn tells how long the others may be.
  void take_turn() {
    if (int(samples_.size()) >= fewest_samples && slow_) return;
    const double ns = draw(slow_ ? 1 : draws_of_a_turn);
    samples_.push_back(ns);
  }
  void warm_up() { slow_ = draw(1) > slow_ns && draw(1) > slow_ns; }  // once might be somebody else's fault
  spread ns_per(double pixels) const {
    std::vector<double> scaled = samples_;
    for (double& x : scaled) x /= pixels;
    return spread_of(scaled);
  }

 private:
  std::vector<double> samples_;
  bool slow_ = false;
};

class our_contestant final : public contestant {
 public:
  our_contestant(const sim::scene& s, const sim::draw_options& o) : scene_(s), options_(o) {}
  double draw(int times) override {
    options_.repeat = times;
    result_ = sim::draw(scene_, options_);
    return result_.ns_per_pixel * double(result_.picture.pixels.size());
  }
  sim::image picture() const override { return result_.picture; }
  const sim::draw_options& options() const { return options_; }
  const sim::draw_result& result() const { return result_; }
  // False where the kernel asked for draws nothing of this: another did.
  bool drew_itself() const { return result_.kernel == sim::name_of(sim::kernel_names, options_.kernel); }

 private:
  const sim::scene& scene_;
  sim::draw_options options_;
  sim::draw_result result_;
};

class peer_contestant final : public contestant {
 public:
  peer_contestant(peers::peer& p, sim::screen_size size) : peer_(p), size_(size) {}
  double draw(int times) override {
    std::vector<double> ns;
    for (int k = 0; k < times; ++k) {
      const double begun = now_ns();
      peer_.draw();
      ns.push_back(now_ns() - begun);
    }
    std::nth_element(ns.begin(), ns.begin() + times / 2, ns.end());
    return ns[size_t(times / 2)];
  }
  sim::image picture() const override { return picture_of(peer_, size_); }
  const char* name() const { return peer_.name(); }

 private:
  peers::peer& peer_;
  sim::screen_size size_;
};

picture_error error_of(const sim::image& picture, const sim::ideal_image& reference) {
  const double psnr = sim::psnr_db(picture, reference);
  return {255 * pow(10, -psnr / 20), sim::worst_error(picture, reference), psnr};
}

struct contest {
  std::vector<std::unique_ptr<our_contestant>> ours;
  std::vector<std::unique_ptr<peer_contestant>> peers;

  template <class Do>
  void each(Do what) {
    for (auto& c : ours) what(static_cast<contestant&>(*c));
    for (auto& c : peers) what(static_cast<contestant&>(*c));
  }
};

void warm_up(contest& all) {
  all.each([](contestant& c) { c.warm_up(); });
  std::erase_if(all.ours, [](const auto& c) { return !c->drew_itself(); });
}

contest contestants(const sim::scene& s, filter kind, const bench_choice& choice, const peer_list& peers) {
  contest all;
  for (const sim::profile_choice profile : choice.profiles)
    for (const kernels::choice kernel : choice.kernels) {
      sim::draw_options o;
      o.kind = kind;
      o.profile = profile;
      o.kernel = kernel;
      if (kind == filter::aniso) o.changes.max_samples = choice.max_samples;
      o.background = background;
      all.ours.push_back(std::make_unique<our_contestant>(s, o));
    }
  if (!peers_can_draw(s)) return all;
  for (const auto& p : peers)
    if (prepare_peer(*p, s, kind)) all.peers.push_back(std::make_unique<peer_contestant>(*p, s.size));
  return all;
}

// Counts are the engine's: of the scalar contestant of the profile, or of one that draws for the purpose.
draw_counters counts_of(const our_contestant& c, const contest& all, const sim::scene& s) {
  for (const auto& other : all.ours) {
    if (other->options().profile != c.options().profile || other->options().kernel != kernels::choice::scalar) continue;
    if (other->result().picture.pixels != c.result().picture.pixels) throw std::logic_error(s.name + ": kernel and engine differ");
    return other->result().work;
  }
  sim::draw_options o = c.options();
  o.repeat = 1;
  o.counted = true;
  return sim::draw(s, o).work;
}

std::vector<bench_row> rows_of(const contest& all, const sim::scene& s, filter kind, const sim::ideal_image& reference) {
  std::vector<bench_row> rows;
  const double pixels = double(s.size.width_px) * s.size.height_px;
  const std::string filter_name(sim::name_of(sim::filter_names, kind));
  const sim::image* ours = nullptr;
  for (const auto& c : all.ours) {
    const sim::draw_options& o = c->options();
    if (o.profile == sim::profile_choice::standard) ours = &c->result().picture;
    rows.push_back({s.name, filter_name, "spantex", std::string(sim::name_of(sim::profile_names, o.profile)),
                    std::string(sim::name_of(sim::kernel_names, o.kernel)), c->ns_per(pixels), error_of(c->result().picture, reference),
                    counts_of(*c, all, s), pixels});
  }
  const double flat_db = sim::flat_psnr_db(reference);
  for (const auto& c : all.peers) {
    const sim::image picture = c->picture();
    bench_row row{s.name, filter_name, c->name(), "", "", c->ns_per(pixels), error_of(picture, reference), {}, pixels};
    row.psnr_ours_db = ours != nullptr ? sim::psnr_db(picture, *ours) : NAN;
    row.right_picture = row.error.psnr_db > flat_db;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double last = double(values.size() - 1);
  const auto at = [&](double k) { return values[size_t(k)]; };
  return {at(ceil(0.5 * last)), at(floor(0.25 * last)), at(ceil(0.75 * last)), at(0), int(values.size())};
}

std::vector<bench_row> measure_scene(const sim::scene& s, const bench_choice& choice, const peer_list& peers, const std::function<void()>& step) {
  const sim::ideal_image reference = sim::render_reference(s, background, sim::hardware_threads());
  step();
  std::vector<bench_row> rows;
  for (const filter kind : choice.filters) {
    contest all = contestants(s, kind, choice, peers);
    warm_up(all);
    for (int round = 0; round < choice.rounds; ++round) all.each([](contestant& c) { c.take_turn(); });
    for (bench_row& row : rows_of(all, s, kind, reference)) rows.push_back(std::move(row));
    step();
  }
  return rows;
}

std::vector<bench_ratio> ratios_of(const std::vector<bench_row>& rows) {
  std::vector<bench_ratio> ratios;
  const std::string_view taken = sim::name_of(sim::kernel_names, kernels::resolved(kernels::choice::fastest));
  const auto faster = [](const bench_row* a, const bench_row& b) { return a == nullptr || b.ns_per_pixel.median < a->ns_per_pixel.median; };
  // The kernel that is taken where none is named, rather than one that happens to be faster here.
  const auto ours_rather = [&](const bench_row* a, const bench_row& b) {
    const bool was_taken = a != nullptr && a->kernel == taken, is_taken = b.kernel == taken;
    return was_taken == is_taken ? faster(a, b) : is_taken;
  };
  for (size_t first = 0, end; first < rows.size(); first = end) {
    const bench_row *ours = nullptr, *peer = nullptr;
    for (end = first; end < rows.size() && rows[end].scene == rows[first].scene && rows[end].filter == rows[first].filter; ++end) {
      const bench_row& r = rows[end];
      if (r.profile == "default" && ours_rather(ours, r)) ours = &r;
      if (r.profile.empty() && r.right_picture && faster(peer, r)) peer = &r;
    }
    if (ours == nullptr || peer == nullptr) continue;
    ratios.push_back({ours->scene, ours->filter, peer->drawer, ours->ns_per_pixel.median, peer->ns_per_pixel.median, ours->error.psnr_db, peer->error.psnr_db});
  }
  return ratios;
}

}  // namespace spantex::tool
