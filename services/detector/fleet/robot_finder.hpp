// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "common/bus/raw_bus.hpp"

namespace rtd::detector {

/// Finds the robots of a domain by their cameras, which announce JPEG images. Thread-safe.
class RobotFinder {
 public:
  /// Joins the domain. Throws BusError.
  explicit RobotFinder(const bus::BusOptions& options);
  ~RobotFinder();
  RobotFinder(const RobotFinder&) = delete;
  RobotFinder& operator=(const RobotFinder&) = delete;

  /// Robots with a camera now; "" is the one without a name.
  std::set<std::string> robots() const;

 private:
  void note(const bus::TopicWriter& writer, bus::WriterChange change);

  mutable std::mutex mutex_;
  std::map<std::string, std::set<bus::WriterId>> cameras_;
  std::shared_ptr<bus::RawBus> bus_;
};

}  // namespace rtd::detector
