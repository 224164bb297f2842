// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>

#include "common/bus/backend.hpp"
#include "common/bus/fastdds/participant.hpp"
#include "common/bus/fastdds/qos_mapping.hpp"

namespace rtd::bus::fastdds {

/// One DataReader with its own thread: Fast DDS's threads only wake it, so a slow callback holds up neither
/// discovery nor other readers; what it cannot take in time, the keep-last history drops.
class FastddsReader : public ReaderBackend, private dds::DataReaderListener {
 public:
  FastddsReader(std::shared_ptr<Participant> participant, std::unique_ptr<Codec> codec, const std::string& topic,
                const dds::DataReaderQos& qos, ErasedCallback on_message, StatusCallbacks callbacks);
  ~FastddsReader() override;
  int matched() const override { return status_.matched(); }
  /// Valid in callbacks, too.
  rtps::GUID_t guid() const { return reader_.load()->guid(); }

 private:
  bool handle_one();
  bool may_have_skipped_one(const dds::DataReader& reader);
  void report_lost() { status_.report_lost(lost_in_transit_ + unusable_); }

  void on_data_available(dds::DataReader*) override { thread_.wake(); }
  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override {
    status_.report_matched(status.current_count);
    const auto writer = rtps::iHandle2GUID(status.last_publication_handle);
    status_.report_writer(to_writer_id(writer), status.current_count_change > 0);
  }
  void on_requested_deadline_missed(dds::DataReader*, const dds::RequestedDeadlineMissedStatus&) override {
    status_.report_deadline_missed();
  }
  void on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) override {
    status_.report_liveliness(status.alive_count);
  }
  void on_requested_incompatible_qos(dds::DataReader*, const dds::RequestedIncompatibleQosStatus& status) override {
    status_.report_incompatible_qos(name_of(status.last_policy_id));
  }
  void on_sample_rejected(dds::DataReader*, const dds::SampleRejectedStatus& status) override {
    status_.report_rejected(status.total_count);
  }
  void on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) override {
    lost_in_transit_ = status.total_count;
    report_lost();
  }

  std::shared_ptr<Participant> participant_;
  dds::Subscriber& subscriber_;
  std::unique_ptr<Codec> codec_;
  const int depth_;
  int skipped_ = 0;  ///< used by the callback thread
  const ErasedCallback on_message_;
  std::atomic<int> lost_in_transit_{0}, unusable_{0};
  std::atomic<dds::DataReader*> reader_{nullptr};
  StatusReporter status_;
  CallbackThread thread_;
  std::optional<TopicTypes::Watch> types_;
  std::optional<NodeEndpoints::Entry> entry_;
};

/// One DataWriter. A loan of a message without 64-bit members is a slot of the writer's own shared memory, which
/// write_loaned() does not copy. Fast DDS's slots begin 4 bytes behind an aligned address, after the CDR header; loans
/// of other messages are memory of our own.
class FastddsWriter : public WriterBackend, private dds::DataWriterListener {
 public:
  FastddsWriter(std::shared_ptr<Participant> participant, std::unique_ptr<Codec> codec, const std::string& topic,
                const dds::DataWriterQos& qos, StatusCallbacks callbacks);
  ~FastddsWriter() override;

  bool write(const void* message) override;
  void* loan() override;
  bool write_loaned(void* slot) override;
  void discard_loan(void* slot) override;
  int matched() const override { return status_.matched(); }
  bool matches(const rtps::GUID_t& reader) const {
    const std::lock_guard lock(readers_mutex_);
    return readers_.contains(reader);
  }
  bool wait_acknowledged(int timeout_ms) override;
  rtps::GUID_t guid() const { return writer_->guid(); }
  WriterId id() const override { return to_writer_id(guid()); }

 private:
  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override {
    {
      const rtps::GUID_t reader = rtps::iHandle2GUID(status.last_subscription_handle);
      const std::lock_guard lock(readers_mutex_);
      if (status.current_count_change > 0)
        readers_.insert(reader);
      else
        readers_.erase(reader);
    }
    status_.report_matched(status.current_count);
  }
  void on_offered_deadline_missed(dds::DataWriter*, const dds::OfferedDeadlineMissedStatus&) override {
    status_.report_deadline_missed();
  }
  void on_offered_incompatible_qos(dds::DataWriter*, const dds::OfferedIncompatibleQosStatus& status) override {
    status_.report_incompatible_qos(name_of(status.last_policy_id));
  }

  std::shared_ptr<Participant> participant_;
  dds::Publisher& publisher_;
  std::unique_ptr<Codec> codec_;
  StatusReporter status_;
  std::optional<TopicTypes::Watch> types_;
  std::map<void*, std::shared_ptr<void>> loans_;
  bool lends_own_memory_ = false;  ///< of the data-sharing pool
  std::set<void*> vendor_loans_;
  mutable std::mutex readers_mutex_;
  std::set<rtps::GUID_t> readers_;  ///< that are matched
  dds::DataWriter* writer_ = nullptr;
  std::optional<NodeEndpoints::Entry> entry_;
};

}  // namespace rtd::bus::fastdds
