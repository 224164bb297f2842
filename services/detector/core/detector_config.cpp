// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {

std::vector<HeadLayout> default_heads() {
  return {{8, {{{10, 13}, {16, 30}, {33, 23}}}},
          {16, {{{30, 61}, {62, 45}, {59, 119}}}},
          {32, {{{116, 90}, {156, 198}, {373, 326}}}}};
}

}  // namespace rtd::detector
