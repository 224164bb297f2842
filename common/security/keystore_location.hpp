// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::security {

/// The keystore that is meant when none is named: RTD_KEYSTORE, ROS_SECURITY_KEYSTORE, else rtd/keystore in the user's
/// configuration (XDG_CONFIG_HOME, ~/.config).
std::string default_keystore();

}  // namespace rtd::security
