// SPDX-License-Identifier: Apache-2.0
// Prints the hash of every small picture: compared between compilers, optimisation levels and machines (tests/scripts/bit_identity.py). With
// an argument only those of one profile.
#include <firmware/apps/picture_hashes.hpp>

#include <cstdio>
#include <cstring>

using namespace spantex;

template <class Prof>
static void print_profile(const char* name, app::scratch& memory) {
  static direct_engine<Prof> engine;
  app::each_hash<Prof>(memory, engine, [&](app::picture p, filter f, wrap w, bool odd, uint32_t hash) {
    std::printf("%s %s %s %s %s %08x\n", name, app::name_of(p), app::name_of(f), app::name_of(w), odd ? "20x12" : "32x32", unsigned(hash));
  });
}

template <class Prof>
static void print_shaded(const char* name, app::scratch& memory) {
  static direct_engine<Prof> engine;
  app::each_shaded_hash<Prof>(memory, engine, [&](app::picture p, const char* style, uint32_t hash) {
    std::printf("%s %s %s repeat 20x12 %08x\n", name, app::name_of(p), style, unsigned(hash));
  });
}

int main(int count, char** arguments) {
  static app::scratch memory;
  const auto wanted = [&](const char* name) { return count < 2 || std::strcmp(arguments[1], name) == 0; };
  if (wanted("seed")) print_profile<fixed_profile<profiles::seed>>("seed", memory);
  if (wanted("compact")) print_profile<fixed_profile<profiles::compact>>("compact", memory);
  if (wanted("default")) print_profile<fixed_profile<profiles::standard>>("default", memory);
  if (wanted("exact")) print_profile<fixed_profile<profiles::exact>>("exact", memory);
  if (wanted("seed")) print_shaded<fixed_profile<profiles::seed>>("seed", memory);
  if (wanted("compact")) print_shaded<fixed_profile<profiles::compact>>("compact", memory);
  if (wanted("default")) print_shaded<fixed_profile<profiles::standard>>("default", memory);
  if (wanted("exact")) print_shaded<fixed_profile<profiles::exact>>("exact", memory);
}
