// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::detector {

/// The 80 COCO class names in the order of the network's class outputs; person is 0.
const std::vector<std::string>& coco_class_names();

}  // namespace rtd::detector
