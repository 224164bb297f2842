// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include <fastdds/dds/subscriber/DataReaderListener.hpp>

#include "common/bus/backend.hpp"
#include "common/bus/callback_thread.hpp"
#include "common/bus/fastdds/participant.hpp"

namespace rtd::bus::fastdds {

/// One DataReader with a thread of its own: Fast DDS's threads only wake it, so a slow callback holds up neither
/// discovery nor other readers; what it cannot take in time, the keep-last history drops.
class FastddsReader : public ReaderBackend, private dds::DataReaderListener {
 public:
  FastddsReader(std::shared_ptr<Participant> participant, std::unique_ptr<Codec> codec, const std::string& topic,
                const dds::DataReaderQos& qos, ErasedCallback on_message, StatusCallbacks callbacks);
  ~FastddsReader() override;
  int matched() const override { return matched_; }

 private:
  bool handle_one();
  bool may_have_skipped_one(const dds::DataReader& reader);
  void report_lost();

  void on_data_available(dds::DataReader*) override { thread_.wake(); }
  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override;
  void on_requested_deadline_missed(dds::DataReader*, const dds::RequestedDeadlineMissedStatus&) override;
  void on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) override;
  void on_requested_incompatible_qos(dds::DataReader*, const dds::RequestedIncompatibleQosStatus& status) override;
  void on_sample_rejected(dds::DataReader*, const eprosima::fastrtps::SampleRejectedStatus& status) override;
  void on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) override;

  std::shared_ptr<Participant> participant_;
  dds::Subscriber& subscriber_;
  std::unique_ptr<Codec> codec_;
  const int depth_;
  int skipped_ = 0;  ///< used by the callback thread
  const ErasedCallback on_message_;
  const StatusCallbacks callbacks_;
  std::atomic<int> matched_{0};
  std::atomic<int> lost_in_transit_{0}, unusable_{0};
  std::atomic<dds::DataReader*> reader_{nullptr};
  CallbackThread thread_;
  std::optional<TopicTypes::Watch> types_;
};

}  // namespace rtd::bus::fastdds
