// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/cyclonedds_reader.hpp"

#include <limits>
#include <utility>

#include "common/bus/cyclonedds/qos_mapping.hpp"

namespace rtd::bus::cyclonedds {

CycloneReader::CycloneReader(std::shared_ptr<Participant> participant, const SampleType& type, const std::string& topic,
                             Qos qos, Handlers handlers)
    : participant_(std::move(participant)), handlers_(std::move(handlers)), thread_([this] { return handle_one(); }) {
  const VendorTopic vendor = participant_->topic(topic, type);
  set_type_hash(*qos, type.name);
  participant_->set_reader_partition(topic, *qos);
  const Listener heard = listener();
  const dds_entity_t reader = dds_create_reader(participant_->handle(), vendor.handle, qos.get(), heard.get());
  if (reader < 0) throw BusError("Cyclone DDS refused a reader on topic " + topic + ": " + dds_strretcode(reader));
  reader_ = reader;
  if (handlers_.status.on_type_mismatch) {
    types_.emplace(participant_->types(), topic, type.name, [this](const std::string& foreign_type) {
      thread_.post([this, foreign_type] { handlers_.status.on_type_mismatch(foreign_type); });
    });
  }
  thread_.wake();  // a sample may have come before reader_ was known
}

CycloneReader::~CycloneReader() {
  types_.reset();
  dds_set_listener(reader_, nullptr);  // waits for a running one
  thread_.stop();                      // waits for a running callback; only now nobody takes from the reader
  dds_delete(reader_);
}

Listener CycloneReader::listener() {
  Listener heard(dds_create_listener(this));
  dds_lset_data_available(heard.get(),
                          [](dds_entity_t, void* self) { static_cast<CycloneReader*>(self)->thread_.wake(); });
  dds_lset_subscription_matched(heard.get(), [](dds_entity_t, dds_subscription_matched_status_t status, void* self) {
    auto& reader = *static_cast<CycloneReader*>(self);
    const int peers = static_cast<int>(status.current_count);
    reader.matched_ = peers;
    if (reader.handlers_.status.on_matched) {
      reader.thread_.post([&reader, peers] { reader.handlers_.status.on_matched(peers); });
    }
  });
  const StatusCallbacks& status = handlers_.status;
  if (status.on_deadline_missed) {
    dds_lset_requested_deadline_missed(
        heard.get(), [](dds_entity_t, dds_requested_deadline_missed_status_t, void* self) {
          auto& reader = *static_cast<CycloneReader*>(self);
          reader.thread_.post([&reader] { reader.handlers_.status.on_deadline_missed(); });
        });
  }
  if (status.on_liveliness) {
    dds_lset_liveliness_changed(heard.get(), [](dds_entity_t, dds_liveliness_changed_status_t changed, void* self) {
      auto& reader = *static_cast<CycloneReader*>(self);
      const int alive = static_cast<int>(changed.alive_count);
      reader.thread_.post([&reader, alive] { reader.handlers_.status.on_liveliness(alive); });
    });
  }
  if (status.on_incompatible_qos) {
    dds_lset_requested_incompatible_qos(heard.get(),
                                        [](dds_entity_t, dds_requested_incompatible_qos_status_t refused, void* self) {
                                          auto& reader = *static_cast<CycloneReader*>(self);
                                          reader.thread_.post([&reader, policy = policy_name(refused.last_policy_id)] {
                                            reader.handlers_.status.on_incompatible_qos(policy);
                                          });
                                        });
  }
  if (status.on_samples_rejected) {
    dds_lset_sample_rejected(heard.get(), [](dds_entity_t, dds_sample_rejected_status_t rejected, void* self) {
      auto& reader = *static_cast<CycloneReader*>(self);
      const int total = static_cast<int>(rejected.total_count);
      reader.thread_.post([&reader, total] { reader.handlers_.status.on_samples_rejected(total); });
    });
  }
  return heard;
}

bool CycloneReader::handle_one() {
  const dds_entity_t reader = reader_;
  if (reader == 0) return false;
  const std::optional<TakenSample> sample = take_sample(reader);
  if (!sample) return false;
  // Cyclone has no word for samples that a writer sent and that will not come; their numbers tell. Those that came
  // through iceoryx have none.
  if (sample->origin.sequence > 0) {
    if (const auto gap = gaps_.next(sample->origin.writer, sample->origin.sequence)) {
      missing_ += gap->count;
      if (handlers_.on_gap) handlers_.on_gap(*gap);
      report_lost();
    }
  }
  if (sample->bytes && !handlers_.on_sample(*sample)) {
    ++unusable_;
    report_lost();
  }
  return true;
}

void CycloneReader::report_lost() {
  constexpr std::uint64_t kMost = std::numeric_limits<int>::max();
  if (handlers_.status.on_samples_lost) {
    handlers_.status.on_samples_lost(static_cast<int>(std::min(missing_ + unusable_, kMost)));
  }
}

}  // namespace rtd::bus::cyclonedds
