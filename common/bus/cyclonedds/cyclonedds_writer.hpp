// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/bus/callback_thread.hpp"
#include "common/bus/cyclonedds/participant.hpp"

namespace rtd::bus::cyclonedds {

/// One writer of samples as bytes.
class CycloneWriter {
 public:
  CycloneWriter(std::shared_ptr<Participant> participant, const SampleType& type, const std::string& topic, Qos qos,
                StatusCallbacks callbacks);
  ~CycloneWriter();
  CycloneWriter(const CycloneWriter&) = delete;
  CycloneWriter& operator=(const CycloneWriter&) = delete;

  dds_entity_t handle() const { return writer_; }
  const ddsi_sertype* type() const { return topic_.type; }
  /// Nobody may change the bytes afterwards. `source_ns` 0: now. Thread-safe.
  bool write(std::shared_ptr<ByteBlock> bytes, std::int64_t source_ns = 0);
  int matched() const { return matched_; }
  bool wait_acknowledged(int timeout_ms);

 private:
  Listener listener();

  std::shared_ptr<Participant> participant_;
  const StatusCallbacks callbacks_;
  VendorTopic topic_;
  std::atomic<int> matched_{0};
  std::optional<CallbackThread> thread_;  ///< only when there are callbacks
  std::mutex mutex_;
  SampleOrigin last_;  ///< as Cyclone counts, for readers in this process
  dds_entity_t writer_ = 0;
  std::optional<TopicTypes::Watch> types_;
};

}  // namespace rtd::bus::cyclonedds
