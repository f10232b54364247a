/* SPDX-License-Identifier: Apache-2.0
 * The version, for C and C++: the one place that says it. Manifests and packages repeat it, tests/scripts/packaging.py compares them.
 * Semantic versioning: before 1.0.0 a new minor version may change interfaces or pixels; a patch changes neither. */
#ifndef SPANTEX_VERSION_H
#define SPANTEX_VERSION_H

#define SPANTEX_VERSION_MAJOR 0
#define SPANTEX_VERSION_MINOR 1
#define SPANTEX_VERSION_PATCH 0
#define SPANTEX_VERSION "0.1.0"

#endif
