// SPDX-License-Identifier: Apache-2.0
// Prints the hash of every small picture: compared between compilers, optimisation levels and machines (tests/scripts/bit_identity.py).
#include <firmware/apps/picture_hashes.hpp>

#include <cstdio>

using namespace spantex;

template <class Prof>
static void print_profile(const char* name, app::scratch& memory) {
  static direct_engine<Prof> engine;
  app::each_hash<Prof>(memory, engine, [&](app::picture p, filter f, wrap w, bool odd, uint32_t hash) {
    std::printf("%s %s %s %s %s %08x\n", name, app::name_of(p), app::name_of(f), app::name_of(w), odd ? "20x12" : "32x32", unsigned(hash));
  });
}

int main() {
  static app::scratch memory;
  print_profile<fixed_profile<profiles::seed>>("seed", memory);
  print_profile<fixed_profile<profiles::compact>>("compact", memory);
  print_profile<fixed_profile<profiles::standard>>("default", memory);
  print_profile<fixed_profile<profiles::exact>>("exact", memory);
}
