// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/detector/core/evaluation/labels.hpp"

namespace rtd::detector {

/// Clips `box` to the image and keeps it; a box without area, outside the image or marked twice becomes a problem at
/// `where` ("file:line").
void add_label(const LabelledBox& box, ImageSize image, const std::string& where, ImageLabels& labels);

}  // namespace rtd::detector
