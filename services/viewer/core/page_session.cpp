// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/page_session.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/service/json_text.hpp"
#include "services/viewer/core/page_messages.hpp"

namespace rtd::viewer {
namespace {

using nlohmann::json;
using service::json_line;

constexpr std::size_t kChunkKeyframes = 512, kChunkBytes = 48 * 1024, kChunkPositions = 4096, kChunkDense = 8192;
constexpr std::size_t kDensePointBytes = 9;

Frame shared_frame(bool text, Payload payload) {
  return {.text = text, .head = {}, .payload = std::move(payload)};
}

bool flag(const json& message, const char* name, bool otherwise) {
  const auto found = message.find(name);
  return found != message.end() && found->is_boolean() ? found->get<bool>() : otherwise;
}

std::string text(const json& message, const char* name) {
  const auto found = message.find(name);
  return found != message.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::uint64_t number(const json& message, const char* name) {
  const auto found = message.find(name);
  return found != message.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}

std::string hello(const PageGreeting& greeting, Rights rights, double now_ms) {
  const bool knows_token = rights == Rights::kControl;
  json message{{"type", "hello"},
               {"protocol", 1},
               {"version", greeting.version},
               {"domain", greeting.domain},
               {"vendor", greeting.vendor},
               {"control", knows_token && greeting.control},
               {"server_ms", now_ms}};
  if (knows_token) message["look_token"] = greeting.look_token;
  return json_line(message);
}

/// Keyframes of one map that changed after `revision`, as many as one message takes, and up to where they reach. A
/// group ends where `fits` says so.
struct ChangedKeyframes {
  std::uint32_t map_id = 0;
  bool removed = false;
  std::vector<page::KeyframeRef> keyframes;
  std::vector<std::uint32_t> ids;
  std::uint64_t revision = 0;
};
ChangedKeyframes changed_after(const ChangeLog<std::uint32_t>& log, const MapMirror& map, std::uint64_t revision,
                               auto fits) {
  ChangedKeyframes changed{.revision = revision};
  log.after(revision, [&](std::uint32_t id, std::uint64_t place) {
    const MirroredKeyframe& keyframe = map.keyframe(id);
    if (changed.ids.empty()) {
      changed.map_id = keyframe.map_id;
      changed.removed = keyframe.removed;
    } else if (keyframe.map_id != changed.map_id || keyframe.removed != changed.removed || !fits(keyframe)) {
      return false;
    }
    changed.keyframes.emplace_back(id, &keyframe);
    changed.ids.push_back(id);
    changed.revision = place;
    return true;
  });
  return changed;
}

}  // namespace

PageSession::PageSession(PageHub& hub, Rights rights)
    : hub_(hub),
      may_control_(rights == Rights::kControl && hub.greeting_.control),
      all_(hub.limits_.bytes_per_s, hub.limits_.burst_bytes),
      views_(hub.limits_.view_bytes_per_s, hub.limits_.view_bytes_per_s / 4) {
  hub_.sessions_.insert(this);
  outbox_.push_control(text_frame(hello(hub_.greeting_, rights, hub_.hooks_.now_ms())));
}

PageSession::~PageSession() {
  hub_.sessions_.erase(this);
}

void PageSession::on_text(std::string_view message_text) {
  const json message = json::parse(message_text, nullptr, false);
  if (!message.is_object()) return;
  const std::string op = text(message, "op");
  if (op == "options") {
    options_ = {flag(message, "image", options_.image),       flag(message, "mask", options_.mask),
                flag(message, "features", options_.features), flag(message, "points", options_.points),
                flag(message, "dense", options_.dense),       flag(message, "people", options_.people),
                flag(message, "moving", options_.moving),     flag(message, "plan", options_.plan),
                flag(message, "depth", options_.depth)};
    ready_ = flag(message, "ready", ready_);
    const auto robot = message.find("robot");
    if (robot != message.end() && robot->is_number_unsigned()) watched_ = robot->get<std::uint64_t>();
  } else if (op == "call") {
    call(number(message, "id"), number(message, "robot"), text(message, "name"), text(message, "argument"));
  } else if (op == "ping") {
    const auto sent = message.find("sent_ms");
    outbox_.push_control(
        text_frame(json_line({{"type", "pong"},
                              {"sent_ms", sent != message.end() && sent->is_number() ? *sent : json(0)},
                              {"server_ms", hub_.hooks_.now_ms()}})));
  }
}

PageOptions PageSession::options(std::uint8_t robot) const {
  PageOptions options = options_;
  if (watched_ && *watched_ != robot) options.image = options.mask = options.features = false;
  options.people = options.people && options.image;
  options.depth = options.depth && options.image;
  return options;
}

void PageSession::on_binary(std::span<const std::byte>) {}  // pages send none

void PageSession::call(std::uint64_t id, std::size_t robot, const std::string& name, const std::string& argument) {
  const auto answer = [this, id, alive = std::weak_ptr(alive_)](const CommandResult& result) {
    if (!alive.expired()) outbox_.push_control(text_frame(page::answer(id, result)));
  };
  if (!may_control_ || !hub_.hooks_.on_call) return answer({false, kOnlyLooks});
  if (robot >= hub_.names_.size()) return answer({false, "this robot is unknown"});
  hub_.hooks_.on_call(hub_.names_[robot], name, argument, answer);
}

std::optional<Frame> PageSession::next(std::int64_t now_ns) {
  all_.refill(now_ns);
  views_.refill(now_ns);
  std::optional<Frame> frame = next_frame(now_ns);
  if (frame) {
    all_.take(frame->size());
    bytes_ += frame->size();
  }
  return frame;
}

std::optional<Frame> PageSession::next_frame(std::int64_t now_ns) {
  if (auto waiting = outbox_.pop()) return waiting;
  if (!all_.allows()) return std::nullopt;
  if (robots_sent_ != hub_.names_.size()) {
    robots_sent_ = hub_.names_.size();
    return text_frame(page::robots(hub_.names_));
  }
  if (atlas_sent_ != hub_.atlas_.revision) {
    atlas_sent_ = hub_.atlas_.revision;
    return shared_frame(true, hub_.atlas_.payload);
  }
  if (auto report = link_report(now_ns)) return report;
  return next_of_robots(now_ns);
}

/// The robots take turns: one with much to send does not use up the budget of the others.
std::optional<Frame> PageSession::next_of_robots(std::int64_t now_ns) {
  const std::size_t robots = hub_.mirrors_.size();
  for (std::size_t turn = 1; turn <= robots; ++turn) {
    const std::size_t index = (served_ + turn) % robots;
    auto frame = next_of(*hub_.mirrors_[index], sent_[index], now_ns);
    if (!frame) continue;
    served_ = index;
    return frame;
  }
  return std::nullopt;
}

std::optional<Frame> PageSession::next_of(const RobotMirror& robot, Sent& sent, std::int64_t now_ns) {
  if (sent.epoch != robot.map().epoch()) {
    const bool first = sent.epoch == 0;
    Sent fresh;
    fresh.epoch = robot.map().epoch();
    fresh.items = sent.items;
    sent = std::move(fresh);
    if (!first) return text_frame(page::map_reset(robot.index()));
  }
  if (auto frame = next_item(robot, sent, now_ns)) return frame;
  if (auto frame = next_poses(robot, sent)) return frame;
  if (auto frame = next_edges(robot, sent)) return frame;
  if (auto frame = next_trajectory(robot, sent)) return frame;
  if (auto frame = next_values(robot, sent)) return frame;
  if (auto frame = next_truth(robot, sent)) return frame;
  if (auto frame = next_view(robot, sent, now_ns)) return frame;
  if (auto frame = next_points(robot, sent)) return frame;
  if (auto frame = next_plan(robot, sent)) return frame;
  if (auto frame = next_dense(robot, sent, CloudKind::kStatic)) return frame;
  return next_dense(robot, sent, CloudKind::kMoving);
}

std::optional<Frame> PageSession::next_item(const RobotMirror& robot, Sent& sent, std::int64_t now_ns) const {
  for (std::size_t place = 0; place < kItems; ++place) {
    const RobotMirror::Message& message = robot.item(static_cast<Item>(place));
    if (message.revision == sent.items[place]) continue;
    if (static_cast<Item>(place) == Item::kTracking) {
      const auto& recent = robot.recent_tracking();
      if (sent.items[place] == 0) sent.recent_until = recent.empty() ? 0 : recent.back().revision;
      if (sent.items[place] < sent.recent_until) {
        const auto next = std::ranges::upper_bound(recent, sent.items[place], {}, &RobotMirror::Message::revision);
        sent.items[place] = next->revision;
        return shared_frame(true, next->payload);
      }
      if (static_cast<double>(now_ns - sent.tracking_ns) * hub_.limits_.messages_per_s < 1e9) continue;
      sent.tracking_ns = now_ns;
    }
    sent.items[place] = message.revision;
    return shared_frame(true, message.payload);
  }
  return std::nullopt;
}

std::optional<Frame> PageSession::next_poses(const RobotMirror& robot, Sent& sent) const {
  std::size_t room = kChunkKeyframes;
  const auto changed =
      changed_after(robot.map().poses(), robot.map(), sent.poses, [&](const MirroredKeyframe&) { return --room > 0; });
  if (changed.ids.empty()) return std::nullopt;
  sent.poses = changed.revision;
  return binary_frame(changed.removed ? page::removed(robot.index(), changed.ids)
                                      : page::poses(robot.index(), changed.map_id, changed.keyframes));
}

std::optional<Frame> PageSession::next_edges(const RobotMirror& robot, Sent& sent) const {
  if (sent.loops != robot.map().loop_revision()) {
    sent.loops = robot.map().loop_revision();
    return binary_frame(page::loop_edges(robot.index(), robot.map().loop_edges()));
  }
  std::size_t bytes = 0;
  const auto changed =
      changed_after(robot.map().edges(), robot.map(), sent.edges, [&](const MirroredKeyframe& keyframe) {
        bytes += 8 + 4 * keyframe.covisible.size();
        return bytes < kChunkBytes;
      });
  if (changed.ids.empty()) return std::nullopt;
  sent.edges = changed.revision;
  return binary_frame(page::covisibility(robot.index(), changed.keyframes));
}

std::optional<Frame> PageSession::next_points(const RobotMirror& robot, Sent& sent) const {
  if (!options_.points) return std::nullopt;
  const std::size_t stride =
      (robot.map().point_count() + hub_.limits_.most_points - 1) / std::max<std::size_t>(hub_.limits_.most_points, 1);
  std::size_t bytes = 0;
  const auto changed =
      changed_after(robot.map().points(), robot.map(), sent.points, [&](const MirroredKeyframe& keyframe) {
        bytes += 12 + 8 * keyframe.points_m.size();
        return bytes < kChunkBytes;
      });
  if (changed.ids.empty()) return std::nullopt;
  sent.points = changed.revision;
  return binary_frame(page::points(robot.index(), changed.map_id, changed.keyframes, stride));
}

std::optional<Frame> PageSession::next_trajectory(const RobotMirror& robot, Sent& sent) const {
  const auto& trajectory = robot.map().trajectory();
  if (sent.trajectory >= trajectory.size()) return std::nullopt;
  const std::size_t start = sent.trajectory, count = std::min(kChunkPositions, trajectory.size() - start);
  sent.trajectory += count;
  return binary_frame(
      page::trajectory(robot.index(), static_cast<std::uint32_t>(start), std::span(trajectory).subspan(start, count)));
}

/// Of what the page has of the trajectory, some at a time; all again when the errors are others.
std::optional<Frame> PageSession::next_values(const RobotMirror& robot, Sent& sent) const {
  constexpr std::size_t kFewest = 10;
  const TruthTrack& truth = robot.truth();
  if (std::exchange(sent.values_revision, truth.revision()) != truth.revision()) sent.values = 0;
  if (sent.trajectory < sent.values + kFewest) return std::nullopt;
  const auto& trajectory = robot.map().trajectory();
  const std::size_t start = sent.values, count = std::min(kChunkPositions, sent.trajectory - start);
  const auto points = std::span(trajectory).subspan(start, count);
  std::vector<float> errors_m;
  for (const TrajectoryPoint& point : points)
    errors_m.push_back(static_cast<float>(truth.error_m(point.stamp_ns).value_or(std::nan(""))));
  sent.values += count;
  return binary_frame(page::trajectory_values(robot.index(), static_cast<std::uint32_t>(start),
                                              trajectory.front().stamp_ns, points, errors_m));
}

std::optional<Frame> PageSession::next_truth(const RobotMirror& robot, Sent& sent) const {
  const TruthTrack& truth = robot.truth();
  if (truth.revision() == 0) return std::nullopt;  // not aligned yet
  if (sent.truth_revision != truth.revision()) {
    sent.truth_revision = truth.revision();
    sent.truth = 0;
  }
  if (sent.truth >= truth.positions_m().size()) return std::nullopt;
  const std::size_t start = sent.truth, count = std::min(kChunkPositions, truth.positions_m().size() - start);
  std::vector<Eigen::Vector3f> points(count);
  for (std::size_t place = 0; place < count; ++place) points[place] = truth.aligned(start + place).cast<float>();
  sent.truth += count;
  return binary_frame(page::truth(robot.index(), static_cast<std::uint32_t>(start), points));
}

/// Overlays first: the image is drawn with the overlays of its stamp that are there. Those that come later are sent
/// when they come.
std::optional<Frame> PageSession::next_view(const RobotMirror& robot, Sent& sent, std::int64_t now_ns) {
  if (sent.view.empty()) {
    if (static_cast<double>(now_ns - sent.view_ns) * hub_.limits_.views_per_s < 1e9 || !views_.allows())
      return std::nullopt;
    const auto view = robot.newest_image();
    if (!view) return std::nullopt;
    choose_parts(*view, options(robot.index()), sent);
    if (sent.view.empty()) return std::nullopt;
    sent.view_ns = now_ns;
  }
  const auto [is_text, payload] = sent.view.back();
  sent.view.pop_back();
  views_.take(payload->size());
  return shared_frame(is_text, payload);
}

/// What the page wants of the view and does not have; the last part goes first.
void PageSession::choose_parts(const AnnotatedImage& view, const PageOptions& wanted, Sent& sent) {
  if (view.stamp_ns != sent.view_stamp_ns) sent.view_parts = {};
  sent.view_stamp_ns = view.stamp_ns;
  struct Part {
    bool wanted, is_text;
    const Payload& payload;
  };
  const std::array<Part, std::tuple_size_v<decltype(sent.view_parts)>> parts = {
      {{wanted.image, false, view.image},
       {wanted.image, true, view.boxes},
       {wanted.depth, false, view.depth},
       {wanted.people, false, view.people},
       {wanted.mask, false, view.mask},
       {wanted.features, false, view.features}}};
  for (std::size_t place = 0; place < parts.size(); ++place) {
    const auto& [is_wanted, is_text, payload] = parts[place];
    if (!is_wanted || !payload || payload == sent.view_parts[place]) continue;
    sent.view_parts[place] = payload;
    sent.view.emplace_back(is_text, payload);
  }
}

std::optional<Frame> PageSession::next_dense(const RobotMirror& robot, Sent& all_sent, CloudKind kind) const {
  const RobotMirror::Dense& dense = robot.dense(kind);
  Sent::Cloud& sent = all_sent.clouds[static_cast<std::size_t>(kind)];
  const bool wanted = kind == CloudKind::kStatic ? options_.dense : options_.moving;
  if (!wanted || dense.revision == 0 || !all_.allows(0.25)) return std::nullopt;
  const std::size_t total = std::min(dense.points.size() / kDensePointBytes, hub_.limits_.most_dense);
  if (sent.revision != dense.revision) {
    if (sent.revision != 0 && !all_.allows(0.9)) return std::nullopt;  // a renewed cloud waits for quiet
    sent = {dense.revision, 0};
  }
  if (sent.points >= total) return std::nullopt;
  const std::size_t start = sent.points, count = std::min(kChunkDense, total - start);
  sent.points += count;
  return binary_frame(page::dense(kind == CloudKind::kStatic ? page::Kind::kDense : page::Kind::kMoving, robot.index(),
                                  static_cast<std::uint32_t>(start), static_cast<std::uint32_t>(total), dense.origin_m,
                                  dense.scale_m,
                                  std::span(dense.points).subspan(start * kDensePointBytes, count * kDensePointBytes)));
}

std::optional<Frame> PageSession::next_plan(const RobotMirror& robot, Sent& sent) const {
  const RobotMirror::Message& plan = robot.plan();
  if (!options_.plan || plan.revision == sent.plan || !all_.allows(0.25)) return std::nullopt;
  sent.plan = plan.revision;
  return shared_frame(false, plan.payload);
}

std::optional<Frame> PageSession::link_report(std::int64_t now_ns) {
  constexpr std::int64_t kPeriodNs = 1'000'000'000;
  if (reported_ns_ == 0) reported_ns_ = now_ns;
  if (now_ns - reported_ns_ < kPeriodNs) return std::nullopt;
  const double kb_per_s = static_cast<double>(bytes_) * 1e6 / static_cast<double>(now_ns - reported_ns_);
  reported_ns_ = now_ns;
  bytes_ = 0;
  return text_frame(json_line({{"type", "link"},
                               {"kBps", static_cast<int>(kb_per_s)},
                               {"dropped", outbox_.dropped()},
                               {"clients", hub_.clients()}}));
}

}  // namespace rtd::viewer
