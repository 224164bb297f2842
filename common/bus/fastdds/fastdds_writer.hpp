// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include <fastdds/dds/publisher/DataWriterListener.hpp>

#include "common/bus/backend.hpp"
#include "common/bus/callback_thread.hpp"
#include "common/bus/fastdds/participant.hpp"

namespace rtd::bus::fastdds {

/// One DataWriter. A loan of a message without 64-bit members is a slot of the writer's own shared memory, which
/// write_loaned() does not copy. Fast DDS's slots begin 4 bytes behind an aligned address, after the CDR header; other
/// messages are lent memory of our own.
class FastddsWriter : public WriterBackend, private dds::DataWriterListener {
 public:
  FastddsWriter(std::shared_ptr<Participant> participant, std::unique_ptr<Codec> codec, const std::string& topic,
                const dds::DataWriterQos& qos, StatusCallbacks callbacks);
  ~FastddsWriter() override;

  bool write(const void* message) override;
  void* loan() override;
  bool write_loaned(void* slot) override;
  void discard_loan(void* slot) override;
  int matched() const override { return matched_; }
  bool wait_acknowledged(int timeout_ms) override;

 private:
  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override;
  void on_offered_deadline_missed(dds::DataWriter*, const dds::OfferedDeadlineMissedStatus&) override;
  void on_offered_incompatible_qos(dds::DataWriter*, const dds::OfferedIncompatibleQosStatus& status) override;

  std::shared_ptr<Participant> participant_;
  dds::Publisher& publisher_;
  std::unique_ptr<Codec> codec_;
  const StatusCallbacks callbacks_;
  std::atomic<int> matched_{0};
  std::optional<CallbackThread> thread_;  ///< only when there are callbacks
  std::optional<TopicTypes::Watch> types_;
  std::map<void*, std::shared_ptr<void>> loans_;
  bool lends_own_memory_ = false;  ///< of the data-sharing pool
  std::set<void*> vendor_loans_;
  dds::DataWriter* writer_ = nullptr;
};

}  // namespace rtd::bus::fastdds
