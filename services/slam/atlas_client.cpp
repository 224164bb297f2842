// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/atlas_client.hpp"

#include <exception>

#include "common/concurrency/thread_priority.hpp"
#include "common/io/byte_source.hpp"
#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/slam/core/store/map_store.hpp"

namespace rtd::slam {
namespace {

std::future<MapContents> read_beside(std::shared_ptr<const msg::Submap> submap) {
  return std::async(std::launch::async, [submap = std::move(submap)] {
    constexpr int kNicer = 5;
    concurrency::lower_thread_priority(kNicer);
    return read_map(io::MemorySource(std::as_bytes(std::span(submap->file))));
  });
}

}  // namespace

AtlasClient::AtlasClient(bus::Bus& bus, const SensorConfig& sensor, const SlamSystem& slam, KeyframeSender& sender,
                         TakeMap take_map, Forget forget)
    : sensor_(sensor),
      slam_(slam),
      sender_(sender),
      take_map_(std::move(take_map)),
      forget_(std::move(forget)),
      arrivals_(std::make_shared<Submaps>(1, concurrency::Overflow::kDropOldest)),
      reader_(bus.reader<msg::Submap>(
          bus::topics::kSubmap,
          [arrivals = arrivals_](std::shared_ptr<const msg::Submap> submap) { arrivals->push(std::move(submap)); })) {}

void AtlasClient::update(const msg::FeatureFrame& frame, const msg::TrackingResult& result) {
  policy_.update(result);
  if (policy_.failed()) give_up();
  receive();
  take();
  if (reader_.matched() > 0 && policy_.due()) query(frame);
}

void AtlasClient::give_up() {
  SPDLOG_WARN("event=submap_given_up cause=\"the camera was not found in the map that the atlas sent\"");
  forget_();
  policy_.pause();
}

void AtlasClient::receive() {
  const auto submap = arrivals_->pop_for(std::chrono::milliseconds(0));
  const bool useful = submap && !reading_.valid() && policy_.wanted() && policy_.is_answer((*submap)->stamp_ns);
  if (useful) reading_ = read_beside(*submap);
}

/// What has been read, unless the camera knows its place meanwhile.
void AtlasClient::take() {
  if (!reading_.valid() || reading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  try {
    MapContents contents = reading_.get();
    if (!policy_.wanted()) return;
    const std::size_t keyframes = contents.keyframes.size(), landmarks = contents.landmarks.size();
    const MapId next_map = contents.next_map;
    const std::int64_t start_ns = service::monotonic_ns();
    if (const std::string difference = take_map_(std::move(contents)); !difference.empty())
      return refuse(difference.c_str());
    policy_.take(next_map);
    SPDLOG_INFO("event=submap_taken keyframes={} landmarks={} ms={:.0f}", keyframes, landmarks,
                static_cast<double>(service::monotonic_ns() - start_ns) * 1e-6);
  } catch (const std::exception& error) {
    refuse(error.what());
  }
}

void AtlasClient::refuse(const char* cause) {
  SPDLOG_WARN("event=submap_refused cause=\"{}\"", cause);
  policy_.pause();
}

void AtlasClient::query(const msg::FeatureFrame& frame) {
  constexpr std::size_t kFewest = 50;  // no place is recognised by fewer
  sensor_.disparity_px_m = slam_.disparity_px_m();
  const FramePtr seen = make_frame(frame, sensor_).frame;
  if (seen == nullptr || seen->features.size() < kFewest) return;
  policy_.note_query();
  sender_.send(make_features(*seen));
}

}  // namespace rtd::slam
