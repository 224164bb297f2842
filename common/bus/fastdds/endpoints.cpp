// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/endpoints.hpp"

#include <type_traits>
#include <utility>

namespace rtd::bus::fastdds {
namespace {

/// With its ring where those of the participant are, and the hash of its type.
template <class Qos>
Qos placed(Qos qos, const dds::Topic& topic, const Participant& participant) {
  if (qos.data_sharing().kind() != dds::OFF) {
    const std::string folder = participant.rings();
    place_ring(qos.data_sharing(), folder);
    constexpr bool kWrites = std::is_same_v<Qos, dds::DataWriterQos>;
    const std::string partitions = participant.ring_partitions(folder, kWrites);
    if (!partitions.empty()) qos.properties().properties().emplace_back("partitions", partitions);
  }
  return with_type_hash(std::move(qos), topic.get_type_name());
}

}  // namespace

FastddsReader::FastddsReader(std::shared_ptr<Participant> participant, std::unique_ptr<Codec> codec,
                             const std::string& topic, const dds::DataReaderQos& qos, ErasedCallback on_message,
                             StatusCallbacks callbacks)
    : participant_(std::move(participant)),
      subscriber_(participant_->subscriber(topic)),
      codec_(std::move(codec)),
      depth_(qos.history().depth),
      on_message_(std::move(on_message)),
      status_(std::move(callbacks), thread_),
      thread_([this] { return handle_one(); }) {
  dds::Topic* const known = participant_->topic(topic, *codec_);
  if (status_.callbacks().on_type_mismatch)
    types_.emplace(participant_->types(), topic, known->get_type_name(), status_);
  reader_ = participant_->create_reader(*known, placed(qos, *known, *participant_), codec_->largest_sample(), *this);
  if (reader_ == nullptr) throw BusError("Fast DDS refused a reader on topic " + topic);
  entry_.emplace(participant_->node_endpoints(), topic, to_writer_id(guid()), NodeEndpoints::Direction::kReads);
  thread_.wake();  // a sample may have come before reader_ was known
}

FastddsReader::~FastddsReader() {
  dds::DataReader* const reader = reader_;
  reader->set_listener(nullptr);
  entry_.reset();
  types_.reset();
  thread_.stop();  // waits for a running callback; only now nothing takes from the reader
  const std::lock_guard lock(participant_->endpoints_mutex());
  subscriber_.delete_datareader(reader);
}

bool FastddsReader::handle_one() {
  dds::DataReader* const reader = reader_;
  if (reader == nullptr) return false;
  TakenSample taken = codec_->take(*reader, status_.callbacks().accepts);
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
      on_message_(std::move(taken.message), taken.writer);
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

FastddsWriter::FastddsWriter(std::shared_ptr<Participant> participant, std::unique_ptr<Codec> codec,
                             const std::string& topic, const dds::DataWriterQos& qos, StatusCallbacks callbacks)
    : participant_(std::move(participant)),
      publisher_(participant_->publisher(topic)),
      codec_(std::move(codec)),
      status_(std::move(callbacks)) {
  dds::Topic* const known = participant_->topic(topic, *codec_);
  if (status_.callbacks().on_type_mismatch)
    types_.emplace(participant_->types(), topic, known->get_type_name(), status_);
  const dds::DataWriterQos asked = placed(qos, *known, *participant_);
  lends_own_memory_ = codec_->in_place() && asked.data_sharing().kind() != dds::OFF;
  {
    const std::lock_guard lock(participant_->endpoints_mutex());
    writer_ = publisher_.create_datawriter(known, asked, this);
  }
  if (writer_ == nullptr) throw BusError("Fast DDS refused a writer on topic " + topic);
  entry_.emplace(participant_->node_endpoints(), topic, id(), NodeEndpoints::Direction::kWrites);
}

FastddsWriter::~FastddsWriter() {
  writer_->set_listener(nullptr);
  entry_.reset();
  publisher_.delete_datawriter(writer_);
}

bool FastddsWriter::write(const void* message) {
  if (codec_->sample_size(message) <= codec_->largest_sample()) return codec_->write(*writer_, message);
  status_.report_too_large();
  return false;
}

void* FastddsWriter::loan() {
  void* lent = nullptr;
  if (lends_own_memory_ && succeeded(writer_->loan_sample(lent))) {
    return *vendor_loans_.insert(lent).first;
  }
  std::shared_ptr<void> slot = codec_->allocate();
  return loans_.emplace(slot.get(), slot).first->first;
}

bool FastddsWriter::write_loaned(void* slot) {
  if (vendor_loans_.erase(slot) > 0) {
    if (succeeded(writer_->write(slot))) return true;
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
  return succeeded(writer_->wait_for_acknowledgments({timeout_ms / 1000, nanoseconds}));
}

}  // namespace rtd::bus::fastdds
