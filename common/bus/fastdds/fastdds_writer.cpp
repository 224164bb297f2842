// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/fastdds_writer.hpp"

#include <exception>
#include <utility>

#include "common/bus/fastdds/qos_mapping.hpp"

namespace rtd::bus::fastdds {

using eprosima::fastrtps::types::ReturnCode_t;

FastddsWriter::FastddsWriter(std::shared_ptr<Participant> participant, std::unique_ptr<Codec> codec,
                             const std::string& topic, const dds::DataWriterQos& qos, StatusCallbacks callbacks)
    : participant_(std::move(participant)),
      publisher_(participant_->publisher(topic)),
      codec_(std::move(codec)),
      callbacks_(std::move(callbacks)) {
  const bool anybody_listens = callbacks_.on_matched || callbacks_.on_incompatible_qos ||
                               callbacks_.on_deadline_missed || callbacks_.on_type_mismatch;
  if (anybody_listens) thread_.emplace();
  if (callbacks_.on_type_mismatch) {
    types_.emplace(
        participant_->types(), topic, codec_->create_type().get_type_name(),
        [this](const std::string& type) { thread_->post([this, type] { callbacks_.on_type_mismatch(type); }); });
  }
  dds::Topic* const known = participant_->topic(topic, *codec_);
  lends_own_memory_ = codec_->in_place() && qos.data_sharing().kind() != dds::OFF;
  writer_ = publisher_.create_datawriter(known, with_type_hash(qos, known->get_type_name()), this);
  if (writer_ == nullptr) throw BusError("Fast DDS refused a writer on topic " + topic);
  participant_->writer_created();
}

FastddsWriter::~FastddsWriter() {
  writer_->set_listener(nullptr);
  publisher_.delete_datawriter(writer_);
}

bool FastddsWriter::write(const void* message) {
  return codec_->write(*writer_, message);
}

void* FastddsWriter::loan() {
  void* lent = nullptr;
  if (lends_own_memory_ && writer_->loan_sample(lent) == ReturnCode_t::RETCODE_OK) {
    return *vendor_loans_.insert(lent).first;
  }
  std::shared_ptr<void> slot = codec_->allocate();
  return loans_.emplace(slot.get(), slot).first->first;
}

bool FastddsWriter::write_loaned(void* slot) {
  if (vendor_loans_.erase(slot) > 0) {
    if (writer_->write(slot)) return true;
    writer_->discard_loan(slot);  // a failed write leaves it lent
    return false;
  }
  const auto node = loans_.extract(slot);
  return !node.empty() && write(slot);
}

void FastddsWriter::discard_loan(void* slot) {
  if (vendor_loans_.erase(slot) > 0) {
    writer_->discard_loan(slot);
  } else {
    loans_.erase(slot);
  }
}

bool FastddsWriter::wait_acknowledged(int timeout_ms) {
  const auto nanoseconds = static_cast<std::uint32_t>(timeout_ms % 1000) * 1'000'000U;
  return writer_->wait_for_acknowledgments({timeout_ms / 1000, nanoseconds}) == ReturnCode_t::RETCODE_OK;
}

void FastddsWriter::on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) {
  matched_ = status.current_count;
  if (!callbacks_.on_matched) return;
  thread_->post([this, peers = status.current_count] { callbacks_.on_matched(peers); });
}

void FastddsWriter::on_offered_deadline_missed(dds::DataWriter*, const dds::OfferedDeadlineMissedStatus&) {
  if (callbacks_.on_deadline_missed) thread_->post([this] { callbacks_.on_deadline_missed(); });
}

void FastddsWriter::on_offered_incompatible_qos(dds::DataWriter*, const dds::OfferedIncompatibleQosStatus& status) {
  if (!callbacks_.on_incompatible_qos) return;
  thread_->post([this, policy = policy_name(status.last_policy_id)] { callbacks_.on_incompatible_qos(policy); });
}

}  // namespace rtd::bus::fastdds
