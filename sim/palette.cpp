// SPDX-License-Identifier: Apache-2.0
// Palettes: median cut (Heckbert 1982) over the distinct colours of a picture, weighted by how often each occurs, then k-means.
#include <algorithm>
#include <array>
#include <utility>

#include "encode.hpp"

namespace spantex::sim {
namespace {

struct weighted {
  std::array<uint8_t, channel_count> value;
  uint64_t count;
};

using iterator = std::vector<weighted>::iterator;

// A run of the colours that will share one palette entry.
struct cluster {
  iterator begin, end;
  size_t channel = 0;   // along which the colours are spread most
  uint64_t spread = 0;  // sum of squared differences from the mean along it
};

std::vector<weighted> distinct_colours(const image& picture) {
  std::vector<std::array<uint8_t, channel_count>> all;
  for (const rgba8& c : picture.pixels) all.push_back({c.r, c.g, c.b, c.a});
  std::sort(all.begin(), all.end());
  std::vector<weighted> out;
  for (const auto& c : all) {
    if (out.empty() || out.back().value != c) out.push_back({c, 0});
    ++out.back().count;
  }
  return out;
}

cluster measured(iterator begin, iterator end) {
  cluster c{begin, end};
  for (size_t k = 0; k < channel_count; ++k) {
    uint64_t n = 0, sum = 0, squares = 0;
    for (iterator p = begin; p != end; ++p) {
      n += p->count;
      sum += p->count * p->value[k];
      squares += p->count * p->value[k] * p->value[k];
    }
    const uint64_t spread = squares - sum * sum / n;  // at most 2^24 texels: sum^2 is below 2^64
    if (spread > c.spread) { c.spread = spread; c.channel = k; }
  }
  return c;
}

// Where the weighted median along the cluster's channel is; at least one colour on either side.
iterator median_cut(const cluster& c) {
  const auto key = [&](const weighted& w) { return std::pair(w.value[c.channel], w.value); };  // total: the colours are distinct
  std::sort(c.begin, c.end, [&](const weighted& a, const weighted& b) { return key(a) < key(b); });
  uint64_t total = 0, before = 0;
  for (iterator p = c.begin; p != c.end; ++p) total += p->count;
  iterator p = c.begin;
  while (p + 1 != c.end && 2 * before < total) before += (p++)->count;
  return p == c.begin ? p + 1 : p;
}

rgba8 mean_of(const std::array<uint64_t, channel_count>& sum, uint64_t n) {
  const auto rounded = [&](size_t k) { return uint8_t((2 * sum[k] + n) / (2 * n)); };
  return {rounded(0), rounded(1), rounded(2), rounded(3)};
}

rgba8 mean_of(const cluster& c) {
  std::array<uint64_t, channel_count> sum{};
  uint64_t n = 0;
  for (iterator p = c.begin; p != c.end; ++p) {
    n += p->count;
    for (size_t k = 0; k < channel_count; ++k) sum[k] += p->count * p->value[k];
  }
  return mean_of(sum, n);
}

// One round of k-means; an entry that no colour is nearest to stays.
void improve(const std::vector<weighted>& colours, palette& entries) {
  struct total { std::array<uint64_t, channel_count> sum{}; uint64_t n = 0; };
  std::vector<total> totals(entries.size());
  for (const weighted& c : colours) {
    const rgba8 colour{c.value[0], c.value[1], c.value[2], c.value[3]};
    total& t = totals[size_t(nearest_colour(entries.data(), int(entries.size()), colour))];
    t.n += c.count;
    for (size_t k = 0; k < channel_count; ++k) t.sum[k] += c.count * c.value[k];
  }
  for (size_t k = 0; k < entries.size(); ++k)
    if (totals[k].n != 0) entries[k] = mean_of(totals[k].sum, totals[k].n);
}

void remove_doubles(palette& entries) {
  palette kept;
  for (const rgba8& c : entries)
    if (std::find(kept.begin(), kept.end(), c) == kept.end()) kept.push_back(c);
  entries = kept;
}

}  // namespace

palette make_palette(const image& picture, int most) {
  if (picture.pixels.empty() || most < 1 || most > 256) throw input_error("palette: wants a picture and 1..256 colours");
  std::vector<weighted> colours = distinct_colours(picture);
  std::vector<cluster> clusters{measured(colours.begin(), colours.end())};
  while (int(clusters.size()) < most) {
    const auto less_spread = [](const cluster& a, const cluster& b) { return a.spread < b.spread; };
    const auto widest = std::max_element(clusters.begin(), clusters.end(), less_spread);
    if (widest->end - widest->begin < 2) break;  // every cluster is one colour: their spreads are 0
    const iterator cut = median_cut(*widest);
    const cluster upper = measured(cut, widest->end);
    *widest = measured(widest->begin, cut);
    clusters.push_back(upper);
  }
  palette entries;
  for (const cluster& c : clusters) entries.push_back(mean_of(c));
  for (int round = 0; round < 3; ++round) improve(colours, entries);
  remove_doubles(entries);
  return entries;
}

}  // namespace spantex::sim
