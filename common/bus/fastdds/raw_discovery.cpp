// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/raw_discovery.hpp"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>

#include "common/bus/fastdds/raw_codec.hpp"
#include "common/bus/fastdds/raw_qos.hpp"

namespace rtd::bus::fastdds {

using eprosima::fastrtps::rtps::WriterDiscoveryInfo;

std::vector<TopicWriter> RawDiscovery::writers() const {
  const std::lock_guard lock(mutex_);
  std::vector<TopicWriter> all;
  for (const auto& [id, writer] : writers_) all.push_back(writer);
  return all;
}

void RawDiscovery::watch(RawBus::Watcher watcher) {
  {
    const std::lock_guard lock(mutex_);
    watcher_ = nullptr;  // nothing more is posted
  }
  thread_.reset();  // waits for a running call
  if (!watcher) return;
  const std::lock_guard lock(mutex_);
  watcher_ = std::move(watcher);
  thread_.emplace();
  for (const auto& [id, writer] : writers_) {
    thread_->post([watcher = watcher_, writer] { watcher(writer, WriterChange::kAppeared); });
  }
}

void RawDiscovery::on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                          WriterDiscoveryInfo&& info) {
  TopicWriter writer = to_topic_writer(info.info);
  const WriterId own = to_writer_id(participant->guid());
  constexpr auto kPrefix = eprosima::fastrtps::rtps::GuidPrefix_t::size;
  writer.own = std::equal(own.begin(), own.begin() + kPrefix, writer.id.begin());
  const std::lock_guard lock(mutex_);
  const auto change = note(writer, info.status == WriterDiscoveryInfo::REMOVED_WRITER);
  if (change && watcher_) thread_->post([watcher = watcher_, writer, change = *change] { watcher(writer, change); });
}

/// Empty: nothing new.
std::optional<WriterChange> RawDiscovery::note(const TopicWriter& writer, bool gone) {
  if (gone) return writers_.erase(writer.id) > 0 ? std::optional(WriterChange::kGone) : std::nullopt;
  const auto [known, is_new] = writers_.try_emplace(writer.id, writer);
  if (is_new) return WriterChange::kAppeared;
  if (known->second.qos == writer.qos && known->second.topic == writer.topic) return std::nullopt;
  known->second = writer;
  return WriterChange::kChanged;
}

}  // namespace rtd::bus::fastdds
