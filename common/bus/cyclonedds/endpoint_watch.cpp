// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/endpoint_watch.hpp"

#include <algorithm>
#include <utility>

namespace rtd::bus::cyclonedds {

EndpointWatch::EndpointWatch(dds_entity_t participant, Direction direction, Note note) : note_(std::move(note)) {
  const Listener heard(dds_create_listener(this));
  dds_lset_data_available(heard.get(), [](dds_entity_t, void* self) { static_cast<EndpointWatch*>(self)->take_all(); });
  const dds_entity_t topic =
      direction == Direction::kWriters ? DDS_BUILTIN_TOPIC_DCPSPUBLICATION : DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION;
  const dds_entity_t reader = dds_create_reader(participant, topic, nullptr, heard.get());
  if (reader < 0) throw BusError(std::string("Cyclone DDS tells nothing of others: ") + dds_strretcode(reader));
  {
    const std::lock_guard lock(mutex_);
    reader_ = reader;
  }
  take_all();  // those that were there before
}

EndpointWatch::~EndpointWatch() {
  dds_set_listener(reader_, nullptr);  // waits for a running one
  dds_delete(reader_);
}

void EndpointWatch::take_all() {
  constexpr std::size_t kAtOnce = 32;
  const std::lock_guard lock(mutex_);
  if (reader_ == 0) return;
  while (true) {
    void* samples[kAtOnce] = {};
    dds_sample_info_t infos[kAtOnce];
    const dds_return_t count = dds_take(reader_, samples, infos, kAtOnce, kAtOnce);
    if (count <= 0) return;
    for (int i = 0; i < count; ++i) {
      const auto* const endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      WriterId id{};
      std::copy_n(endpoint->key.v, id.size(), id.begin());
      const bool there = infos[i].instance_state == DDS_IST_ALIVE && infos[i].valid_data;
      note_(id, there ? endpoint : nullptr);
    }
    dds_return_loan(reader_, samples, count);
  }
}

}  // namespace rtd::bus::cyclonedds
