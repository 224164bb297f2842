// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/callback_thread.hpp"
#include "common/bus/cyclonedds/participant.hpp"
#include "common/bus/cyclonedds/sample_io.hpp"
#include "common/bus/sequence_gaps.hpp"

namespace rtd::bus::cyclonedds {

/// One reader with a thread of its own: Cyclone's threads only wake it, so a slow callback holds up neither discovery
/// nor other readers; what it cannot take in time, the keep-last history drops.
class CycloneReader : public ReaderBackend {
 public:
  struct Handlers {
    std::function<bool(const TakenSample&)> on_sample;  ///< false: absurd content, to be counted as lost
    std::function<void(const RawLoss&)> on_gap;         ///< before the sample that revealed it
    StatusCallbacks status;
  };

  CycloneReader(std::shared_ptr<Participant> participant, const SampleType& type, const std::string& topic, Qos qos,
                Handlers handlers);
  ~CycloneReader() override;
  int matched() const override { return matched_; }

 private:
  Listener listener();
  bool handle_one();
  void report_lost();

  std::shared_ptr<Participant> participant_;
  const Handlers handlers_;
  SequenceGaps gaps_;                         // used by the callback thread
  std::uint64_t missing_ = 0, unusable_ = 0;  // as well
  std::atomic<int> matched_{0};
  std::atomic<dds_entity_t> reader_{0};
  std::optional<TopicTypes::Watch> types_;
  CallbackThread thread_;
};

}  // namespace rtd::bus::cyclonedds
