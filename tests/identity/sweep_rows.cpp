// SPDX-License-Identifier: Apache-2.0
// Rows of a sweep without the command, assimp, libzip, libpng and libdeflate, for machines that do not have them: sweep_rows SPEC.json FIRST STEP prints the heading and every
// STEP-th point's row from point FIRST on. tests/scripts/sweep_identity.py compares them with this machine's.
#include <stdio.h>
#include <stdlib.h>

#include <sim/file.hpp>
#include <sim/level.hpp>
#include <sim/model.hpp>
#include <sim/sweep_judge.hpp>
#include <tools/spantex/sweep_record.hpp>

using namespace spantex;

namespace spantex::sim {
// The study draws no models, no levels and no pictures of files.
world load_model(const std::string& path, const model_options&) { throw input_error(path + ": no models here"); }
level load_level(const std::string& path, const std::string&, const model_options&) { throw input_error(path + ": no levels here"); }
bool is_level(const std::string&) { return false; }
std::vector<viewpoint> tour(const level&, int) { return {}; }
image load_image(const std::string& path) { throw input_error(path + ": no pictures here"); }
image decode_image(const uint8_t*, size_t, const std::string& name) { throw input_error(name + ": no pictures here"); }
bytes encode_png(const image&) { throw input_error("no pictures here"); }
}  // namespace spantex::sim

int main(int count, char** arguments) {
  if (count != 4) return 2;
  const tool::sweep_spec spec = tool::sweep_spec::load(arguments[1]);
  const uint64_t first = strtoull(arguments[2], nullptr, 10), step = strtoull(arguments[3], nullptr, 10);
  sim::sweep_subjects subjects;
  printf("%s\n", tool::sweep_heading().c_str());
  for (uint64_t number = first; number < spec.points(); number += step) {
    const tool::numbered_point p = spec.at(number);
    printf("%s\n", tool::sweep_row(spec, number, p, sim::judge(p.point, p.part->measures, subjects)).c_str());
  }
}
