// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/fastdds_reader.hpp"

#include <utility>

#include "common/bus/fastdds/qos_mapping.hpp"

namespace rtd::bus::fastdds {

FastddsReader::FastddsReader(std::shared_ptr<Participant> participant, std::unique_ptr<Codec> codec,
                             const std::string& topic, const dds::DataReaderQos& qos, ErasedCallback on_message,
                             StatusCallbacks callbacks)
    : participant_(std::move(participant)),
      subscriber_(participant_->subscriber(topic)),
      codec_(std::move(codec)),
      depth_(qos.history().depth),
      on_message_(std::move(on_message)),
      callbacks_(std::move(callbacks)),
      thread_([this] { return handle_one(); }) {
  dds::Topic* const known = participant_->topic(topic, *codec_);
  if (callbacks_.on_type_mismatch) {
    const std::string type = codec_->create_type().get_type_name();
    types_.emplace(participant_->types(), topic, type, [this](const std::string& foreign_type) {
      thread_.post([this, foreign_type] { callbacks_.on_type_mismatch(foreign_type); });
    });
  }
  reader_ = subscriber_.create_datareader(known, with_type_hash(qos, known->get_type_name()), this);
  if (reader_ == nullptr) throw BusError("Fast DDS refused a reader on topic " + topic);
  thread_.wake();  // a sample may have come before reader_ was known
}

FastddsReader::~FastddsReader() {
  dds::DataReader* const reader = reader_;
  reader->set_listener(nullptr);
  types_.reset();
  thread_.stop();  // waits for a running callback; only now nobody takes from the reader
  subscriber_.delete_datareader(reader);
}

bool FastddsReader::handle_one() {
  dds::DataReader* const reader = reader_;
  if (reader == nullptr) return false;
  TakenSample taken = codec_->take(*reader);
  switch (taken.kind) {
    case TakenSample::Kind::kNothing:
      return may_have_skipped_one(*reader);
    case TakenSample::Kind::kNoData:
      break;
    case TakenSample::Kind::kUnusable:
      ++unusable_;
      report_lost();
      break;
    case TakenSample::Kind::kMessage:
      skipped_ = 0;
      on_message_(std::move(taken.message));
      break;
  }
  return true;
}

/// Fast DDS says "no data" also when it has just dropped an overwritten sample, with good ones behind it. Unread
/// samples may also be waiting for a repair, hence the limit.
bool FastddsReader::may_have_skipped_one(const dds::DataReader& reader) {
  const bool again = skipped_ < depth_ && reader.get_unread_count() > 0;
  skipped_ = again ? skipped_ + 1 : 0;
  return again;
}

void FastddsReader::report_lost() {
  if (!callbacks_.on_samples_lost) return;
  thread_.post([this, total = lost_in_transit_ + unusable_] { callbacks_.on_samples_lost(total); });
}

void FastddsReader::on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) {
  matched_ = status.current_count;
  if (!callbacks_.on_matched) return;
  thread_.post([this, peers = status.current_count] { callbacks_.on_matched(peers); });
}

void FastddsReader::on_requested_deadline_missed(dds::DataReader*, const dds::RequestedDeadlineMissedStatus&) {
  if (callbacks_.on_deadline_missed) thread_.post([this] { callbacks_.on_deadline_missed(); });
}

void FastddsReader::on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) {
  if (!callbacks_.on_liveliness) return;
  thread_.post([this, alive = status.alive_count] { callbacks_.on_liveliness(alive); });
}

void FastddsReader::on_requested_incompatible_qos(dds::DataReader*, const dds::RequestedIncompatibleQosStatus& status) {
  if (!callbacks_.on_incompatible_qos) return;
  thread_.post([this, policy = policy_name(status.last_policy_id)] { callbacks_.on_incompatible_qos(policy); });
}

void FastddsReader::on_sample_rejected(dds::DataReader*, const eprosima::fastrtps::SampleRejectedStatus& status) {
  if (!callbacks_.on_samples_rejected) return;
  thread_.post([this, total = status.total_count] { callbacks_.on_samples_rejected(total); });
}

void FastddsReader::on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) {
  lost_in_transit_ = status.total_count;
  report_lost();
}

}  // namespace rtd::bus::fastdds
