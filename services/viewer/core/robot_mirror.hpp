// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/status.hpp"
#include "services/viewer/core/command_forms.hpp"
#include "services/viewer/core/map_mirror.hpp"
#include "services/viewer/core/outbox.hpp"
#include "services/viewer/core/truth_track.hpp"

namespace rtd::viewer {

namespace page {
struct ServiceLine;
}

using Payload = std::shared_ptr<const Bytes>;

/// What a page shows of one robot and only the newest of matters, each as a message that is ready to be sent.
enum class Item { kTracking, kCommands, kPlayback, kStatus, kMovers, kTruthError };
inline constexpr std::size_t kItems = 6;

/// An image with what the other services found in it. Parts that are missing are null.
struct View {
  std::int64_t stamp_ns = 0;
  Payload image, features, mask, boxes;
  std::size_t bytes() const;
};

/// All that a page can show of one robot. One thread.
class RobotMirror {
 public:
  explicit RobotMirror(std::uint8_t index) : index_(index) {}

  /// `finished_ms`: when the pose was ready, ms since 1970.
  void add(const msg::TrackingResult& result, double finished_ms);
  void add(const msg::FeatureFrame& frame);
  void add(const msg::CompressedImage& image);
  void add(const msg::Detection2DArray& detections);
  void add(const msg::Image& mask);
  void add(const msg::ServiceStatus& status, std::int64_t received_ns);
  void add(const msg::PointCloud2& dense);
  void add_truth(std::int64_t stamp_ns, const Eigen::Vector3d& position_m);
  void set_commands(const std::vector<CommandInfo>& commands);
  /// Any other item, as JSON without "robot".
  void set(Item item, std::string json);
  /// Renews what grows old without messages: states and ages of services.
  void refresh(std::int64_t now_ns);

  MapMirror& map() { return map_; }
  const MapMirror& map() const { return map_; }
  std::uint8_t index() const { return index_; }

  struct Message {
    std::uint64_t revision = 0;  ///< 0: nothing yet
    Payload payload;
  };
  const Message& item(Item item) const { return items_[static_cast<std::size_t>(item)]; }
  /// The newest image, when the filter has had the time to look at it, with its overlays.
  std::optional<View> newest_view() const;
  const TruthTrack& truth() const { return truth_; }
  std::vector<msg::ServiceStatus> services() const;
  std::vector<page::ServiceLine> services(std::int64_t now_ns) const;
  /// Dense points, 9 bytes each as on the wire, and how to read them.
  struct Dense {
    std::uint64_t revision = 0;
    Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
    float scale_m = 0;
    Bytes points;
  };
  const Dense& dense() const { return dense_; }

 private:
  struct Overlay {
    std::int64_t stamp_ns;
    Payload payload;
  };
  using Overlays = std::deque<Overlay>;
  struct KnownService {
    msg::ServiceStatus status;
    std::int64_t received_ns;
  };

  void set_payload(Item item, std::string text);
  static void keep(Overlays& overlays, std::int64_t stamp_ns, Payload payload);
  static Payload at(const Overlays& overlays, std::int64_t stamp_ns, std::int64_t tolerance_ns);

  const std::uint8_t index_;
  MapMirror map_;
  std::array<Message, kItems> items_;
  Overlays images_, features_, masks_, boxes_;
  std::map<std::string, KnownService> services_;
  std::optional<std::array<float, msg::kFilterStages>> filter_stage_ms_;
  TruthTrack truth_;
  Dense dense_;
};

}  // namespace rtd::viewer
