// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace rtd::service {

/// Text of config/profiles/<name>.yaml by name; compiled in, so that a bare executable knows them.
const std::map<std::string, std::string>& built_in_profiles();

}  // namespace rtd::service
