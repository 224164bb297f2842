// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::viewer {

/// Opens an address with xdg-open. False where no desktop of this user is at hand: no display, a login over SSH, no
/// xdg-open. The address, with its token, stands in a file in the user's own run-time folder and not on a command
/// line, which all users can read.
bool open_in_browser(const std::string& address);

}  // namespace rtd::viewer
