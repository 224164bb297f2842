// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/map_publisher.hpp"

#include <algorithm>

#include "common/concurrency/thread_priority.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::slam {
namespace {

msg::MapKeyframe make_entry(const KeyframeView& keyframe, const KeyframeNews& news) {
  msg::MapKeyframe entry;
  entry.keyframe_id = keyframe.id;
  entry.map_id = keyframe.map;
  entry.stamp_ns = keyframe.stamp_ns;
  entry.T_world_camera = msg::to_message(keyframe.T_world_camera);
  if (news.points) {
    entry.content |= msg::kMapPoints;
    entry.points_m.reserve(3 * keyframe.points_m.size());
    for (const Eigen::Vector3f& point : keyframe.points_m)
      entry.points_m.insert(entry.points_m.end(), {point.x(), point.y(), point.z()});
  }
  if (news.edges) {
    entry.content |= msg::kMapEdges;
    entry.covisible = keyframe.covisible;
  }
  return entry;
}

msg::MapKeyframe make_removal(KeyframeId id) {
  msg::MapKeyframe entry;
  entry.keyframe_id = id;
  entry.T_world_camera = msg::to_message(Eigen::Isometry3d::Identity());
  entry.content = msg::kMapRemoved;
  return entry;
}

std::size_t bytes_of(const msg::MapKeyframe& entry) {
  constexpr std::size_t kFixed = 96;
  return kFixed + sizeof(float) * entry.points_m.size() + sizeof(std::uint32_t) * entry.covisible.size();
}

}  // namespace

std::vector<msg::MapUpdate> make_map_updates(const MapView& view, const MapNews& news, std::size_t max_bytes) {
  std::vector<msg::MapUpdate> updates;
  if (news.empty()) return updates;
  const std::size_t empty_bytes = sizeof(std::uint32_t) * view.loop_edges.size();
  std::size_t bytes = empty_bytes;
  updates.emplace_back().loop_edges = view.loop_edges;
  auto keyframe = view.keyframes.begin();  // in the order of the news
  for (const KeyframeNews& one : news.keyframes) {
    while (!one.removed && keyframe->id != one.id) ++keyframe;
    msg::MapKeyframe entry = one.removed ? make_removal(one.id) : make_entry(*keyframe, one);
    if (bytes + bytes_of(entry) > max_bytes && !updates.back().keyframes.empty()) {
      updates.emplace_back().loop_edges = view.loop_edges;
      bytes = empty_bytes;
    }
    bytes += bytes_of(entry);
    updates.back().keyframes.push_back(std::move(entry));
  }
  return updates;
}

MapPublisher::MapPublisher(bus::Bus& bus, std::function<MapView()> view, std::chrono::milliseconds period)
    : view_(std::move(view)), period_(period) {
  bus::StatusCallbacks callbacks;
  callbacks.on_matched = [this](int readers) {
    if (readers > readers_) newcomer_ns_ = service::monotonic_ns();
    readers_ = readers;
  };
  writer_ = bus.writer(bus::topics::kMap, std::move(callbacks));
  thread_ = std::thread([this] { loop(); });
}

MapPublisher::~MapPublisher() {
  ended_.request_stop();
  thread_.join();
}

void MapPublisher::loop() {
  constexpr int kNicer = 5;  // as the mapper: what holds the map must not wait for less urgent work
  constexpr int kRest = 20;  // times the work
  concurrency::lower_thread_priority(kNicer);
  std::chrono::nanoseconds pause = period_;
  while (!ended_.wait_for(pause)) {
    pause = period_;
    if (writer_.matched() == 0) {
      changes_.forget();  // whoever comes next gets all, and this takes memory
      continue;
    }
    const std::int64_t start_ns = service::monotonic_ns();
    const MapChanges::Extent extent = next_extent();
    const MapView view = view_();
    const MapNews news = changes_.update(view, extent);
    if (news.new_session) begin_session(view.session);
    std::vector<msg::MapUpdate> updates = make_map_updates(view, news);
    pause = std::max(pause, kRest * std::chrono::nanoseconds(service::monotonic_ns() - start_ns));
    send(updates);
  }
}

void MapPublisher::begin_session(std::uint64_t map) {
  const std::lock_guard lock(mutex_);
  session_ = {std::max(service::realtime_ns(), session_.session_ns + 1), map};
  revision_ = 0;
}

MapPublisher::Session MapPublisher::session() const {
  const std::lock_guard lock(mutex_);
  return session_;
}

/// Each side matches on its own: what is written before the reader has matched too never reaches it.
MapChanges::Extent MapPublisher::next_extent() {
  constexpr std::int64_t kSettleNs = 200'000'000;
  std::int64_t newcomer_ns = newcomer_ns_;
  if (newcomer_ns == 0 || service::monotonic_ns() - newcomer_ns < kSettleNs) return MapChanges::Extent::kChanges;
  // One that comes at this very moment stays to be served.
  newcomer_ns_.compare_exchange_strong(newcomer_ns, 0);
  return MapChanges::Extent::kEverything;
}

/// Never more on the way than readers keep.
void MapPublisher::send(std::span<msg::MapUpdate> updates) {
  constexpr std::size_t kOnTheWay = 16;
  for (std::size_t i = 0; i < updates.size() && !ended_.stop_requested(); ++i) {
    updates[i].session_ns = session_.session_ns;
    updates[i].revision = ++revision_;
    writer_.write(updates[i]);
    if ((i + 1) % kOnTheWay == 0 || i + 1 == updates.size()) wait_for_readers();
  }
  if (updates.empty() && behind_) wait_for_readers();
}

/// A reader that does not keep up holds the others up once. When it is back, all start again from nothing.
void MapPublisher::wait_for_readers() {
  constexpr int kPatienceMs = 2000, kShortPatienceMs = 20;
  const bool acknowledged = writer_.wait_acknowledged(behind_ ? kShortPatienceMs : kPatienceMs);
  if (!acknowledged && !behind_) SPDLOG_WARN("event=map_reader_slow cause=\"a reader of rtd/map has not kept up\"");
  if (acknowledged && behind_) changes_.forget();
  behind_ = !acknowledged;
}

}  // namespace rtd::slam
