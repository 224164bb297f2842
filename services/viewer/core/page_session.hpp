// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "services/viewer/core/page_hub.hpp"

namespace rtd::viewer {

/// A rate in bytes per second with a reserve for bursts. It may go into debt by one message.
class TokenBucket {
 public:
  TokenBucket(double per_s, double most) : per_s_(per_s), most_(most), tokens_(most) {}
  void refill(std::int64_t now_ns) {
    if (last_ns_ != 0) tokens_ = std::min(most_, tokens_ + per_s_ * 1e-9 * static_cast<double>(now_ns - last_ns_));
    last_ns_ = now_ns;
  }
  bool allows(double share_kept = 0) const { return tokens_ > share_kept * most_; }
  void take(std::size_t bytes) { tokens_ -= static_cast<double>(bytes); }

 private:
  double per_s_, most_, tokens_;
  std::int64_t last_ns_ = 0;
};

/// One open page. It knows what of each mirror it has sent; next() makes the message of what is missing most, so a slow
/// page gets fewer and newer messages, and nothing waits in a queue but answers. One thread.
class PageSession : public Session {
 public:
  PageSession(PageHub& hub, Rights rights);
  ~PageSession() override;
  PageSession(const PageSession&) = delete;
  PageSession& operator=(const PageSession&) = delete;

  void on_text(std::string_view text) override;
  void on_binary(std::span<const std::byte> bytes) override;
  std::optional<Frame> next(std::int64_t now_ns) override;
  bool overflowed() const override { return outbox_.overflowed(); }
  /// What the page wants of a robot.
  PageOptions options(std::uint8_t robot) const;
  /// The page can draw.
  bool ready() const { return ready_; }

 private:
  /// What the page has of one robot.
  struct Sent {
    std::uint64_t epoch = 0, poses = 0, points = 0, edges = 0, loops = 0;
    std::size_t trajectory = 0, truth = 0, values = 0;
    std::uint64_t truth_revision = 0, values_revision = 0, plan = 0;
    struct Cloud {
      std::uint64_t revision = 0;
      std::size_t points = 0;
    };
    std::array<Cloud, kCloudKinds> clouds{};
    std::array<std::uint64_t, kItems> items{};
    std::uint64_t recent_until = 0;  ///< poses from before the page was open come up to this revision
    std::int64_t tracking_ns = 0, view_ns = 0, view_stamp_ns = 0;
    std::array<Payload, 6> view_parts;           ///< of that stamp
    std::vector<std::pair<bool, Payload>> view;  ///< parts still to be sent: text or not
  };

  std::optional<Frame> next_frame(std::int64_t now_ns);
  std::optional<Frame> next_of_robots(std::int64_t now_ns);
  std::optional<Frame> next_of(const RobotMirror& robot, Sent& sent, std::int64_t now_ns);
  std::optional<Frame> next_item(const RobotMirror& robot, Sent& sent, std::int64_t now_ns) const;
  std::optional<Frame> next_poses(const RobotMirror& robot, Sent& sent) const;
  std::optional<Frame> next_edges(const RobotMirror& robot, Sent& sent) const;
  std::optional<Frame> next_points(const RobotMirror& robot, Sent& sent) const;
  std::optional<Frame> next_trajectory(const RobotMirror& robot, Sent& sent) const;
  std::optional<Frame> next_values(const RobotMirror& robot, Sent& sent) const;
  std::optional<Frame> next_truth(const RobotMirror& robot, Sent& sent) const;
  std::optional<Frame> next_view(const RobotMirror& robot, Sent& sent, std::int64_t now_ns);
  static void choose_parts(const AnnotatedImage& view, const PageOptions& wanted, Sent& sent);
  std::optional<Frame> next_dense(const RobotMirror& robot, Sent& sent, CloudKind kind) const;
  std::optional<Frame> next_plan(const RobotMirror& robot, Sent& sent) const;
  std::optional<Frame> link_report(std::int64_t now_ns);
  void call(std::uint64_t id, std::size_t robot, const std::string& name, const std::string& argument);

  PageHub& hub_;
  const bool may_control_;
  Outbox outbox_;
  PageOptions options_;
  bool ready_ = false;
  std::optional<std::uint64_t> watched_;      ///< whose images the page shows; none: those of all robots
  std::map<std::size_t, Sent> sent_;          ///< by the robot's index
  std::uint64_t atlas_sent_ = 0;              ///< its revision
  std::size_t robots_sent_ = 0, served_ = 0;  ///< served_: whose message was the last one
  TokenBucket all_, views_;
  std::int64_t reported_ns_ = 0;
  std::uint64_t bytes_ = 0;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< answers may come when this is gone
};

}  // namespace rtd::viewer
