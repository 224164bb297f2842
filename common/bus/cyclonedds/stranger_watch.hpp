// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/ddsrt/log.h>

#include <memory>

#include "common/bus/bus_factory.hpp"
#include "common/bus/callback_thread.hpp"
#include "common/bus/cyclonedds/strangers.hpp"

namespace rtd::bus::cyclonedds {

/// Tells BusOptions::on_problem of participants that a secured one cannot meet, while it lives. The domain's
/// configuration must have the discovery trace (domain_config).
class StrangerWatch {
 public:
  /// None without security, or when nobody wants to be told. To be there before the domain is joined.
  static std::unique_ptr<StrangerWatch> start(const BusOptions& options);
  ~StrangerWatch();
  StrangerWatch(const StrangerWatch&) = delete;
  StrangerWatch& operator=(const StrangerWatch&) = delete;

 private:
  explicit StrangerWatch(const BusOptions& options);
  static void dispatch(void*, const dds_log_data_t* line);
  void hear(const dds_log_data_t& line);

  const std::function<void(const std::string&)> on_problem_;
  Strangers strangers_;    ///< under the lock of all watches
  CallbackThread thread_;  ///< Cyclone's own hold locks while they write the trace
};

}  // namespace rtd::bus::cyclonedds
