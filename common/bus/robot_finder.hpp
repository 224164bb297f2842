// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <set>
#include <string>

#include "common/bus/backend.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/bus/topics.hpp"

namespace rtd::bus {

/// Finds the robots of a domain by those of their topics that a program writes. Thread-safe.
class RobotFinder {
 public:
  /// Robots with a writer of `topic`. Joins the domain once more. Throws BusError.
  template <class T>
  RobotFinder(const BusOptions& options, const Topic<T>& topic)
      : RobotFinder(options, topic.name, dds_type_name(MessageTraits<T>::kId)) {}
  RobotFinder(const BusOptions& options, std::string topic, std::string dds_type);

  /// Those there now; "" is the one without a name.
  std::set<std::string> robots() const;

 private:
  const std::string topic_, dds_type_;
  const std::shared_ptr<RawBus> bus_;
};

}  // namespace rtd::bus
