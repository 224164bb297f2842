// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/keystore_location.hpp"

#include <cstdlib>

namespace rtd::security {
namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string() : value;
}

}  // namespace

std::string default_keystore() {
  for (const char* name : {"RTD_KEYSTORE", "ROS_SECURITY_KEYSTORE"}) {
    if (std::string named = variable(name); !named.empty()) return named;
  }
  const std::string config = variable("XDG_CONFIG_HOME");
  return (config.empty() ? variable("HOME") + "/.config" : config) + "/rtd/keystore";
}

}  // namespace rtd::security
