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

#include "common/geometry/mover_trails.hpp"
#include "common/msg/features.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/status.hpp"
#include "services/viewer/core/command_forms.hpp"
#include "services/viewer/core/map_mirror.hpp"
#include "services/viewer/core/outbox.hpp"

namespace rtd::viewer {

/// Ground truth next to the tracked positions, aligned to them by the rigid motion with the smallest squared error
/// (Umeyama 1991), as docs/evaluation.md does it after the run. One thread.
class TruthTrack {
 public:
  void add_truth(std::int64_t stamp_ns, const Eigen::Vector3d& position_m);
  void add_estimate(std::int64_t stamp_ns, const Eigen::Vector3d& position_m);

  /// Counts alignments that differ visibly from the one before: all points are to be drawn again.
  std::uint64_t revision() const { return revision_; }
  const std::vector<Eigen::Vector3d>& positions_m() const { return truth_m_; }
  Eigen::Vector3d aligned(std::size_t place) const { return T_map_truth_ * truth_m_[place]; }
  /// Frames with both, and the absolute trajectory error (root mean square) over them; 0 before there are ten.
  std::size_t pairs() const { return paired_truth_m_.size(); }
  double ate_m() const { return ate_m_; }
  /// Distance of the pose with that stamp from the truth; empty: not known, or not aligned yet.
  std::optional<double> error_m(std::int64_t stamp_ns) const;
  /// Aligns again when the number of pairs has grown by a tenth, or by 30.
  void align_if_grown();

 private:
  void pair();
  void align();

  struct Stamped {
    std::int64_t stamp_ns;
    Eigen::Vector3d position_m;
  };
  std::vector<Eigen::Vector3d> truth_m_;
  std::deque<Stamped> waiting_truth_, waiting_estimates_;
  std::vector<Eigen::Vector3d> paired_truth_m_, paired_estimate_m_;
  std::vector<std::int64_t> paired_stamps_ns_;
  Eigen::Isometry3d T_map_truth_ = Eigen::Isometry3d::Identity();
  std::size_t aligned_pairs_ = 0;
  double ate_m_ = 0;
  std::uint64_t revision_ = 0;
};

namespace page {
struct ServiceLine;
}

using Payload = std::shared_ptr<const Bytes>;

/// What a page shows of one robot and only the newest of matters, each as a message that is ready to be sent.
enum class Item { kTracking, kCommands, kPlayback, kStatus, kMovers, kTruthError };
inline constexpr std::size_t kItems = 6;

/// Of dense points: what stays, what moved.
enum class CloudKind { kStatic, kMoving };
inline constexpr std::size_t kCloudKinds = 2;

/// An image with what the other services found in it. Parts that are missing are null.
struct AnnotatedImage {
  std::int64_t stamp_ns = 0;
  Payload image, features, mask, boxes, people, depth;
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
  /// The detector's person masks.
  void add_people(const msg::Image& masks);
  /// The picture of the camera's depth.
  void add_depth(const msg::CompressedImage& picture);
  void add(const msg::ServiceStatus& status, std::int64_t received_ns);
  void add(CloudKind kind, const msg::PointCloud2& cloud);
  void add(const msg::OccupancyGrid& plan);
  void add(const msg::Movers& movers);
  void add_truth(std::int64_t stamp_ns, const Eigen::Vector3d& position_m);
  void set_commands(const std::vector<CommandInfo>& commands);
  /// Any other item. A revision stands for a content: what is set again unchanged is not sent again.
  void set(Item item, const std::string& json);
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
  /// Poses of about the last minute, some a second, oldest first: the plots of a page that opens later.
  const std::deque<Message>& recent_tracking() const { return recent_tracking_; }
  /// The newest image that the filter has looked at, with its overlays; without a filter, the newest one.
  std::optional<AnnotatedImage> newest_image() const;
  bool has_image() const { return !images_.empty(); }
  const TruthTrack& truth() const { return truth_; }
  std::vector<page::ServiceLine> services(std::int64_t now_ns) const;
  /// Dense points, 9 bytes each as on the wire, and how to read them. The first n are spread over all.
  struct Dense {
    std::uint64_t revision = 0;
    Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
    float scale_m = 0;
    Bytes points;
  };
  const Dense& dense(CloudKind kind) const { return dense_[static_cast<std::size_t>(kind)]; }
  /// The floor plan as a message that is ready to be sent.
  const Message& plan() const { return plan_; }

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

  bool filter_is_late() const;
  static void keep(Overlays& overlays, std::int64_t stamp_ns, Payload payload);
  static Payload at(const Overlays& overlays, std::int64_t stamp_ns, std::int64_t tolerance_ns);

  const std::uint8_t index_;
  MapMirror map_;
  geometry::MoverTrails trails_;
  std::array<Message, kItems> items_;
  std::deque<Message> recent_tracking_;
  double recent_ms_ = 0;  ///< when the newest of them was ready
  Overlays images_, features_, masks_, boxes_, people_, depths_;
  std::map<std::string, KnownService> services_;
  std::optional<std::array<float, msg::kFilterStages>> filter_stage_ms_;
  TruthTrack truth_;
  std::array<Dense, kCloudKinds> dense_;
  Message plan_;
};

}  // namespace rtd::viewer
