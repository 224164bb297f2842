// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/cyclonedds_writer.hpp"

#include <utility>

#include "common/bus/cyclonedds/qos_mapping.hpp"
#include "common/bus/cyclonedds/sample_io.hpp"

namespace rtd::bus::cyclonedds {

CycloneWriter::CycloneWriter(std::shared_ptr<Participant> participant, const SampleType& type, const std::string& topic,
                             Qos qos, StatusCallbacks callbacks)
    : participant_(std::move(participant)), callbacks_(std::move(callbacks)), topic_(participant_->topic(topic, type)) {
  const bool anybody_listens = callbacks_.on_matched || callbacks_.on_incompatible_qos ||
                               callbacks_.on_deadline_missed || callbacks_.on_type_mismatch;
  if (anybody_listens) thread_.emplace();
  set_type_hash(*qos, type.name);
  participant_->set_writer_partition(topic, *qos);
  const Listener heard = listener();
  writer_ = dds_create_writer(participant_->handle(), topic_.handle, qos.get(), heard.get());
  if (writer_ < 0) throw BusError("Cyclone DDS refused a writer on topic " + topic + ": " + dds_strretcode(writer_));
  last_.writer = guid_of(writer_);
  if (callbacks_.on_type_mismatch) {
    types_.emplace(participant_->types(), topic, type.name, [this](const std::string& foreign_type) {
      thread_->post([this, foreign_type] { callbacks_.on_type_mismatch(foreign_type); });
    });
  }
}

CycloneWriter::~CycloneWriter() {
  types_.reset();
  dds_set_listener(writer_, nullptr);  // waits for a running one
  dds_delete(writer_);
}

Listener CycloneWriter::listener() {
  Listener heard(dds_create_listener(this));
  dds_lset_publication_matched(heard.get(), [](dds_entity_t, dds_publication_matched_status_t status, void* self) {
    auto& writer = *static_cast<CycloneWriter*>(self);
    const int peers = static_cast<int>(status.current_count);
    writer.matched_ = peers;
    if (writer.callbacks_.on_matched) {
      writer.thread_->post([&writer, peers] { writer.callbacks_.on_matched(peers); });
    }
  });
  if (callbacks_.on_deadline_missed) {
    dds_lset_offered_deadline_missed(heard.get(), [](dds_entity_t, dds_offered_deadline_missed_status_t, void* self) {
      auto& writer = *static_cast<CycloneWriter*>(self);
      writer.thread_->post([&writer] { writer.callbacks_.on_deadline_missed(); });
    });
  }
  if (callbacks_.on_incompatible_qos) {
    dds_lset_offered_incompatible_qos(heard.get(),
                                      [](dds_entity_t, dds_offered_incompatible_qos_status_t refused, void* self) {
                                        auto& writer = *static_cast<CycloneWriter*>(self);
                                        writer.thread_->post([&writer, policy = policy_name(refused.last_policy_id)] {
                                          writer.callbacks_.on_incompatible_qos(policy);
                                        });
                                      });
  }
  return heard;
}

bool CycloneWriter::write(std::shared_ptr<ByteBlock> bytes, std::int64_t source_ns) {
  const std::lock_guard lock(mutex_);
  SampleOrigin next = last_;
  ++next.sequence;
  if (!write_sample(writer_, topic_.type, std::move(bytes), next, source_ns)) return false;
  last_ = next;
  return true;
}

bool CycloneWriter::wait_acknowledged(int timeout_ms) {
  return dds_wait_for_acks(writer_, DDS_MSECS(timeout_ms)) == DDS_RETCODE_OK;
}

}  // namespace rtd::bus::cyclonedds
