// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/map_changes.hpp"

#include <algorithm>
#include <span>

#include "common/geometry/se3.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kKeyframesAtOnce = 500, kLandmarksAtOnce = 20'000;  // about 2 ms each
constexpr int kMinDrawn = 50;  ///< landmarks in common that make an edge worth drawing

std::vector<KeyframeId> edges_of(const Keyframe& keyframe) {
  std::vector<KeyframeId> older;
  for (const auto& [other, shared] : keyframe.covisible) {
    if (other > keyframe.id) break;
    if (shared >= kMinDrawn || other == keyframe.parent) older.push_back(other);
  }
  return older;
}

/// Up to kKeyframesAtOnce keyframes behind those that the view has; false when there are no more.
bool append_keyframes(const Map& map, MapView& view) {
  const KeyframeId last = view.keyframes.empty() ? kNoKeyframe : view.keyframes.back().id;
  auto next = last == kNoKeyframe ? map.keyframes().begin() : map.keyframes().upper_bound(last);
  for (std::size_t i = 0; i < kKeyframesAtOnce && next != map.keyframes().end(); ++i, ++next) {
    const Keyframe& keyframe = next->second;
    view.keyframes.push_back(
        {keyframe.id, keyframe.map, keyframe.frame->stamp_ns, keyframe.T_world_camera, {}, {}, edges_of(keyframe)});
  }
  return next != map.keyframes().end();
}

KeyframeView* find(MapView& view, KeyframeId id) {
  const auto found = std::ranges::lower_bound(view.keyframes, id, {}, &KeyframeView::id);
  return found == view.keyframes.end() || found->id != id ? nullptr : &*found;
}

/// Gives landmarks to their keyframes. Neighbours in `ids` mostly have the same one.
void append_landmarks(const Map& map, std::span<const LandmarkId> ids, MapView& view) {
  KeyframeId reference = kNoKeyframe;
  KeyframeView* keyframe = nullptr;
  Eigen::Isometry3d T_camera_world;
  for (const LandmarkId id : ids) {
    const Landmark* landmark = map.find_landmark(id);
    if (landmark == nullptr) continue;
    if (landmark->reference != reference) {
      reference = landmark->reference;
      const Keyframe* living = map.find_keyframe(reference);
      keyframe = living == nullptr ? nullptr : find(view, reference);
      if (keyframe != nullptr) T_camera_world = living->T_world_camera.inverse();
    }
    if (keyframe == nullptr) continue;  // came after its keyframe's portion
    keyframe->landmarks.push_back(id);
    keyframe->points_m.emplace_back((T_camera_world * landmark->position).cast<float>());
  }
}

void append_loops(const Map& map, MapView& view) {
  for (const LoopEdge& loop : map.loops()) {
    const KeyframeId older = map.living_ancestor(loop.older).first, newer = map.living_ancestor(loop.newer).first;
    if (older != newer) view.loop_edges.insert(view.loop_edges.end(), {older, newer});
  }
}

}  // namespace

MapView copy_view(const ReadMap& read) {
  MapView view;
  for (bool more = true; more;) read([&](const Map& map) { more = append_keyframes(map, view); });
  std::vector<LandmarkId> ids;
  read([&](const Map& map) {
    ids = map.landmark_ids();
    append_loops(map, view);
  });
  for (std::size_t begin = 0; begin < ids.size(); begin += kLandmarksAtOnce) {
    const auto portion = std::span(ids).subspan(begin, std::min(kLandmarksAtOnce, ids.size() - begin));
    read([&](const Map& map) { append_landmarks(map, portion, view); });
  }
  return view;
}

MapNews MapChanges::update(const MapView& view, Extent extent) {
  MapNews news;
  news.new_session = session_ != view.session;
  if (news.new_session) {
    reported_.clear();
    loop_edges_.clear();
    session_ = view.session;
  }
  take_out_removed(view, news);
  std::vector<PointsNow> points_now(view.keyframes.size(), PointsNow::kOthers);
  for (std::size_t i = 0; i < view.keyframes.size() && extent == Extent::kChanges; ++i) {
    const auto reported = reported_.find(view.keyframes[i].id);
    if (reported != reported_.end()) points_now[i] = compare_points(reported->second, view.keyframes[i]);
  }
  choose_refined(view, points_now);
  for (std::size_t i = 0; i < view.keyframes.size(); ++i) {
    const KeyframeView& now = view.keyframes[i];
    const auto [place, is_new] = reported_.try_emplace(now.id);
    Reported& reported = place->second;
    const bool points = points_now[i] == PointsNow::kOthers;
    const bool edges = is_new || extent == Extent::kEverything || reported.covisible != now.covisible;
    if (!points && !edges && !has_moved(reported, now)) continue;
    reported.map = now.map;
    reported.T_world_camera = now.T_world_camera;
    if (points) {
      reported.landmarks = now.landmarks;
      reported.points_m = now.points_m;
    }
    if (edges) reported.covisible = now.covisible;
    news.keyframes.push_back({now.id, points, edges, false});
  }
  news.loops = loop_edges_ != view.loop_edges;
  loop_edges_ = view.loop_edges;
  return news;
}

/// Both are in the order of ids.
void MapChanges::take_out_removed(const MapView& view, MapNews& news) {
  auto now = view.keyframes.begin();
  for (auto reported = reported_.begin(); reported != reported_.end();) {
    while (now != view.keyframes.end() && now->id < reported->first) ++now;
    if (now != view.keyframes.end() && now->id == reported->first) {
      ++reported;
      continue;
    }
    news.keyframes.push_back({reported->first, false, false, true});
    reported = reported_.erase(reported);
  }
}

bool MapChanges::has_moved(const Reported& reported, const KeyframeView& now) const {
  if (reported.map != now.map) return true;
  const Eigen::Isometry3d T_reported_now = reported.T_world_camera.inverse() * now.T_world_camera;
  return T_reported_now.translation().norm() > tolerance_.translation_m ||
         geometry::rotation_angle_rad(T_reported_now) > tolerance_.rotation_rad;
}

MapChanges::PointsNow MapChanges::compare_points(const Reported& reported, const KeyframeView& now) const {
  if (reported.landmarks != now.landmarks) return PointsNow::kOthers;
  PointsNow points = PointsNow::kSame;
  for (std::size_t i = 0; i < now.points_m.size(); ++i) {
    const double moved_m = static_cast<double>((reported.points_m[i] - now.points_m[i]).norm());
    if (moved_m <= tolerance_.point_m) continue;
    if (moved_m > tolerance_.point_share * static_cast<double>(now.points_m[i].norm())) return PointsNow::kOthers;
    points = PointsNow::kRefined;
  }
  return points;
}

/// Some of the keyframes whose points were refined get their turn: theirs count as others.
void MapChanges::choose_refined(const MapView& view, std::vector<PointsNow>& points) {
  const std::size_t count = view.keyframes.size();
  std::size_t left = std::max(tolerance_.refined_at_once, count / 100);
  const auto first = std::ranges::lower_bound(view.keyframes, next_refined_, {}, &KeyframeView::id);
  for (std::size_t i = 0, at = static_cast<std::size_t>(first - view.keyframes.begin()); i < count && left > 0; ++i) {
    PointsNow& now = points[(at + i) % count];
    if (now != PointsNow::kRefined) continue;
    now = PointsNow::kOthers;
    next_refined_ = view.keyframes[(at + i) % count].id + 1;
    --left;
  }
}

}  // namespace rtd::slam
