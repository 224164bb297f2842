// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::test {

/// The path of the network for masks: the one that is there, else converted out of RTD_MODEL_DIR/permissive into the
/// folder of temporary files. Empty without both.
std::string mask_network();

}  // namespace rtd::test
