// SPDX-License-Identifier: Apache-2.0
// Vector kernels: rows of spans in linear light: what differs from those of colours as coded is how texels become pixels. Included by the machines' files alone.
#pragma once

namespace linear_light {

#include "linear_light.hpp"
#include "spans.hpp"
#include "aniso.hpp"
#include "kernel.hpp"

}  // namespace linear_light
