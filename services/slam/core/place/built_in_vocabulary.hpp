// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "services/slam/core/place/vocabulary.hpp"

namespace rtd::slam {

/// The vocabulary that was trained when this program was built (rtd-train-vocabulary) and lies inside it. Read at the
/// first call, then shared. Any thread.
std::shared_ptr<const Vocabulary> built_in_vocabulary();

}  // namespace rtd::slam
