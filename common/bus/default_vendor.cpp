// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus_factory.hpp"

namespace rtd::bus {

std::string default_vendor() {
#if defined(RTD_HAVE_FASTDDS)
  return "fastdds";
#elif defined(RTD_HAVE_CYCLONEDDS)
  return "cyclonedds";
#else
  return "inprocess";
#endif
}

}  // namespace rtd::bus
