// SPDX-License-Identifier: Apache-2.0
// The small pictures of one profile (-DSPANTEX_PROFILE=seed, compact, standard or exact) and their hashes, in the lines of tests/golden/picture_hashes.txt.
#include "picture_hashes.hpp"

#include <firmware/targets/console.hpp>

using namespace spantex;
using word_lengths = fixed_profile<profiles::SPANTEX_PROFILE>;

static app::scratch pictures;
static direct_engine<word_lengths> unit;

template <int Count>
static void print_words(const char* const (&words)[Count], uint32_t hash) {
  for (const char* word : words) {
    console::print(word);
    console::print(" ");
  }
  console::print_hex(hash);
  console::print("\n");
}

int main() {
  constexpr const char* name = SPANTEX_NAME;
  app::each_hash<word_lengths>(pictures, unit, [&](app::picture p, filter f, wrap w, bool odd, uint32_t hash) {
    const char* const words[] = {name, app::name_of(p), app::name_of(f), app::name_of(w), odd ? "20x12" : "32x32"};
    print_words(words, hash);
  });
  app::each_shaded_hash<word_lengths>(pictures, unit, [&](app::picture p, const char* style, uint32_t hash) {
    const char* const words[] = {name, app::name_of(p), style, "repeat", "20x12"};
    print_words(words, hash);
  });
  return 0;
}
