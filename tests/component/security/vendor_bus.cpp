// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/component/security/vendor_bus.hpp"

#include "common/bus/vendors.hpp"

namespace rtd::bus {

std::shared_ptr<RawBus> connect_unchecked(const BusOptions& options) {
#ifdef RTD_HAVE_CYCLONEDDS
  if (options.vendor == "cyclonedds") return cyclonedds::create_raw_bus(options);
#endif
#ifdef RTD_HAVE_FASTDDS
  if (options.vendor == "fastdds") return fastdds::create_raw_bus(options);
#endif
  throw BusError("no bus " + options.vendor);
}

}  // namespace rtd::bus
