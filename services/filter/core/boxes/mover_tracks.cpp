// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/mover_tracks.hpp"

#include <algorithm>
#include <cmath>

#include "common/vision/samples.hpp"
#include "services/filter/core/boxes/assignment.hpp"
#include "services/filter/core/motion/ego_motion.hpp"

namespace rtd::filter {
namespace {

constexpr int kConfirmHits = 3;           ///< a surface seen moving less often is not yet a mover
constexpr double kConfirmS = 0.13;        ///< ... nor is one first seen moving less long ago
constexpr double kAccelerationMS2 = 0.5;  ///< of a mover without a class
/// Unseen for this long, it is masked where its track expects it; before that memory does so.
constexpr double kExpectAfterS = 1.0;
constexpr double kMaxUnseenWayM = 0.5;  ///< farther than this unseen, it may be anywhere

constexpr std::size_t kMinCells = 40, kEnoughCells = 300;  // every n-th cell of a large surface is enough

Eigen::Vector3d point_world(const MoverFrame& frame, int cell) {
  const auto i = static_cast<std::size_t>(cell);
  return frame.pose.T_world_camera * (frame.rays[i] * frame.grid.depth_m[i]).cast<double>();
}

std::vector<std::vector<int>> by_cluster(const DepthClusters& clusters, const CellMask& moving) {
  std::vector<std::vector<int>> cells(clusters.cells.size());
  for (std::size_t cell = 0; cell < moving.size(); ++cell) {
    if (moving[cell] != 0 && clusters.label[cell] >= 0)
      cells[static_cast<std::size_t>(clusters.label[cell])].push_back(static_cast<int>(cell));
  }
  return cells;
}

Eigen::AlignedBox3d extent_of(const std::vector<int>& cells, const MoverFrame& frame) {
  std::array<std::vector<double>, 3> along;
  const std::size_t step = 1 + cells.size() / kEnoughCells;
  for (std::size_t i = 0; i < cells.size(); i += step) {
    const Eigen::Vector3d p = point_world(frame, cells[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) along[axis].push_back(p[static_cast<Eigen::Index>(axis)]);
  }
  Eigen::AlignedBox3d extent;
  for (int axis = 0; axis < 3; ++axis) {
    std::tie(extent.min()[axis], extent.max()[axis]) = vision::spread(along[static_cast<std::size_t>(axis)]);
  }
  return extent;
}

bool touches_border(const std::vector<int>& cells, const GridShape& shape) {
  constexpr int kBorderCells = 2;
  constexpr std::ptrdiff_t kFew = 4;
  return std::count_if(cells.begin(), cells.end(), [&](int cell) {
           const int column = cell % shape.columns, row = cell / shape.columns;
           return std::min({column, row, shape.columns - 1 - column, shape.rows - 1 - row}) < kBorderCells;
         }) > kFew;
}

/// First and last cell that [first_px, last_px] touches, within 0 .. count - 1; empty when it ends before it begins.
std::pair<int, int> cell_span(double first_px, double last_px, int count, int cell_px) {
  const auto cell = [&](double px) {
    return static_cast<int>(std::floor(std::clamp(px / cell_px, -1.0, count * 1.0)));
  };
  return {std::max(0, cell(first_px)), std::min(count - 1, cell(last_px))};
}

constexpr double kPositionSigmaM = 0.05, kFirstSpeedMS = 0.5;
constexpr double kMarginM = 0.06, kMaxMarginM = 0.3, kMarginPerWay = 0.3;  // it may change direction

/// Two movers have merged or one has split: the centre jumps without any such motion.
bool changes_shape(const Eigen::Vector3d& half_before_m, const Eigen::Vector3d& half_m) {
  constexpr double kLonger = 1.25, kLarger = 2.0;
  const double longer = half_m.maxCoeff() / half_before_m.maxCoeff();
  const double larger = half_m.head<2>().prod() / half_before_m.head<2>().prod();
  return longer > kLonger || longer < 1 / kLonger || larger > kLarger || larger < 1 / kLarger;
}

}  // namespace

std::vector<MoverSighting> sight_movers(const MoverFrame& frame, const DepthClusters& clusters,
                                        const CellMask& moving) {
  std::vector<MoverSighting> sightings;
  for (const std::vector<int>& cells : by_cluster(clusters, moving)) {
    if (cells.size() < kMinCells) continue;
    const Eigen::AlignedBox3d extent = extent_of(cells, frame);
    const std::optional<Box> box = project(extent, frame);
    if (box) sightings.push_back({extent, *box, touches_border(cells, frame.grid.shape)});
  }
  return sightings;
}

std::optional<Box> project(const Eigen::AlignedBox3d& box_world, const MoverFrame& frame) {
  constexpr double kMinDepthM = 0.1;
  const auto& p = frame.camera.parameters();
  const Eigen::Isometry3d T_camera_world = frame.pose.T_world_camera.inverse();
  Eigen::AlignedBox2d image;
  for (int i = 0; i < 8; ++i) {
    const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(i);
    const Eigen::Vector3d p_camera = T_camera_world * box_world.corner(corner);
    if (p_camera.z() < kMinDepthM) return std::nullopt;
    image.extend(Eigen::Vector2d(p.fx * p_camera.x() / p_camera.z() + p.cx, p.fy * p_camera.y() / p_camera.z() + p.cy));
  }
  return Box{image.center(), image.sizes()};
}

BoxContent look_into(const Eigen::AlignedBox3d& box_world, const MoverFrame& frame) {
  BoxContent content;
  const std::optional<Box> box = project(box_world, frame);
  if (!box) return content;
  const GridShape& shape = frame.grid.shape;
  const Eigen::Vector2d first = box->centre_px - 0.5 * box->size_px, last = box->centre_px + 0.5 * box->size_px;
  const auto [first_column, last_column] = cell_span(first.x(), last.x(), shape.columns, shape.cell_px);
  const auto [first_row, last_row] = cell_span(first.y(), last.y(), shape.rows, shape.cell_px);
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const int cell = shape.index(column, row);
      if (frame.grid.depth_m[static_cast<std::size_t>(cell)] <= 0) continue;
      ++content.measured;
      if (box_world.contains(point_world(frame, cell))) content.cells.push_back(cell);
    }
  }
  return content;
}

Eigen::AlignedBox3d MoverTracks::Track::extent(double margin_m) const {
  const Eigen::Vector3d centre(axes[0].state[0], axes[1].state[0], axes[2].state[0]);
  const Eigen::Vector3d half = half_m.array() + margin_m;
  return {centre - half, centre + half};
}

double MoverTracks::margin_m(const Track& track) const {
  return std::min(kMaxMarginM, kMarginM + kMarginPerWay * track.velocity().norm() * track.unseen_s());
}

bool MoverTracks::confirmed(const Track& track) const {
  return track.hits >= kConfirmHits && msg::minus_s(track.seen_ns, track.first_ns) >= kConfirmS;
}

CellMask MoverTracks::expected(const MoverFrame& frame) const {
  CellMask mask(static_cast<std::size_t>(frame.grid.shape.size()), 0);
  for (Track track : tracks_) {
    predict(track, frame.pose.stamp_ns);
    if (!confirmed(track) || !track.out_of_sight || track.unseen_s() < kExpectAfterS) continue;
    for (const int cell : look_into(track.extent(margin_m(track)), frame).cells)
      mask[static_cast<std::size_t>(cell)] = 1;
  }
  return mask;
}

void MoverTracks::update(const MoverFrame& frame, const DepthClusters& clusters, const CellMask& moving,
                         const FeatureVotes& slow_votes) {
  const std::vector<MoverSighting> sightings = sight_movers(frame, clusters, moving);
  const double elapsed_s = tracks_.empty() ? 0.0 : msg::minus_s(frame.pose.stamp_ns, tracks_.front().now_ns);
  for (Track& track : tracks_) predict(track, frame.pose.stamp_ns);
  const std::vector<int> sighting_of = assign_to_tracks(sightings, frame);
  std::vector<char> known(sightings.size(), 0);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (sighting_of[i] < 0) {
      miss(tracks_[i], elapsed_s, frame, slow_votes);
    } else {
      hit(tracks_[i], sightings[static_cast<std::size_t>(sighting_of[i])]);
      known[static_cast<std::size_t>(sighting_of[i])] = 1;
    }
  }
  std::erase_if(tracks_, [this](const Track& track) { return ended(track); });
  for (std::size_t j = 0; j < sightings.size(); ++j) {
    if (known[j] == 0) start_track(sightings[j], frame.pose.stamp_ns);
  }
}

void MoverTracks::predict(Track& track, std::int64_t stamp_ns) const {
  const double dt_s = msg::minus_s(stamp_ns, track.now_ns);
  if (dt_s <= 0) return;
  for (AxisKalman& axis : track.axes) axis.predict(dt_s, kAccelerationMS2);
  track.now_ns = stamp_ns;
}

std::vector<int> MoverTracks::assign_to_tracks(const std::vector<MoverSighting>& sightings,
                                               const MoverFrame& frame) const {
  constexpr double kMinOverlap = 0.1, kMaxApartM = 0.3, kMaxCost = 1.2;
  CostMatrix costs(static_cast<int>(tracks_.size()), static_cast<int>(sightings.size()));
  for (int i = 0; i < costs.rows; ++i) {
    const Eigen::AlignedBox3d extent = tracks_[static_cast<std::size_t>(i)].extent(0);
    const std::optional<Box> box = project(extent, frame);
    for (int j = 0; box && j < costs.columns; ++j) {
      const MoverSighting& sighting = sightings[static_cast<std::size_t>(j)];
      const double apart_m = sighting.extent_world.exteriorDistance(extent);
      const double overlap = intersection_over_union(*box, sighting.box_px);
      if (overlap >= kMinOverlap && apart_m <= kMaxApartM) costs.at(i, j) = 1 - overlap + apart_m;
    }
  }
  return assign(costs, kMaxCost);
}

void MoverTracks::place(Track& track, const Eigen::AlignedBox3d& extent_world) const {
  const Eigen::Vector3d centre = extent_world.center();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    track.axes[axis].state = {centre[static_cast<Eigen::Index>(axis)], 0};
    track.axes[axis].covariance =
        Eigen::Vector2d(kPositionSigmaM * kPositionSigmaM, kFirstSpeedMS * kFirstSpeedMS).asDiagonal();
  }
  track.half_m = 0.5 * extent_world.sizes();
}

void MoverTracks::hit(Track& track, const MoverSighting& sighting) const {
  constexpr double kNewShare = 0.2;
  track.seen_ns = track.now_ns;
  track.rest_s = track.gone_s = 0;
  track.out_of_sight = false;
  ++track.hits;
  if (sighting.cut_off && track.whole) return;  // a part of it says little about its centre
  track.whole = !sighting.cut_off;
  const Eigen::Vector3d half_m = 0.5 * sighting.extent_world.sizes();
  if (changes_shape(track.half_m, half_m)) return place(track, sighting.extent_world);
  const Eigen::Vector3d centre = sighting.extent_world.center();
  for (std::size_t axis = 0; axis < 3; ++axis)
    track.axes[axis].update({1, 0}, centre[static_cast<Eigen::Index>(axis)], kPositionSigmaM);
  track.half_m += kNewShare * (half_m - track.half_m);
}

/// Checks a mover that was not seen moving: is it in sight, still there, at rest?
void MoverTracks::miss(Track& track, double elapsed_s, const MoverFrame& frame, const FeatureVotes& slow_votes) const {
  constexpr double kMostlyVisible = 0.5, kMinFoundShare = 0.2, kRestingRatio = 5;
  constexpr int kMinVotes = 6;
  const std::optional<Box> box = project(track.extent(0), frame);
  const double cell_px2 = frame.grid.shape.cell_px * frame.grid.shape.cell_px;
  const double awaited = box ? box->area_px2() / cell_px2 : 0.0;
  const auto& image = frame.camera.parameters();
  const bool in_sight = box && visible_share(*box, Eigen::Vector2d(image.width, image.height)) > kMostlyVisible &&
                        look_into(track.extent(0), frame).measured > kMostlyVisible * awaited;
  if (!in_sight) {
    track.out_of_sight = true;
    return;
  }
  const BoxContent content = look_into(track.extent(margin_m(track)), frame);
  if (static_cast<double>(content.cells.size()) < kMinFoundShare * content.measured) track.gone_s += elapsed_s;
  int resting = 0, moving = 0;
  for (const FeatureVote& vote : slow_votes.votes) {
    if (std::binary_search(content.cells.begin(), content.cells.end(), vote.cell)) ++(vote.moving ? moving : resting);
  }
  if (resting >= kMinVotes && resting >= kRestingRatio * moving)
    track.rest_s += std::max(elapsed_s, seconds(kLookBackEveryNs));
}

bool MoverTracks::ended(const Track& track) const {
  constexpr double kUnconfirmedS = 0.3;
  return track.rest_s > config_.rest_s || track.gone_s > config_.gone_s || track.unseen_s() > config_.max_unseen_s ||
         track.unseen_s() * track.velocity().norm() > kMaxUnseenWayM ||
         (!confirmed(track) && track.unseen_s() > kUnconfirmedS);
}

void MoverTracks::start_track(const MoverSighting& sighting, std::int64_t stamp_ns) {
  if (tracks_.size() >= kMaxTracks) return;
  Track track;
  track.id = next_id_++;
  track.first_ns = track.now_ns = track.seen_ns = stamp_ns;
  track.whole = !sighting.cut_off;
  place(track, sighting.extent_world);
  tracks_.push_back(track);
}

std::vector<TrackedMover> MoverTracks::movers() const {
  std::vector<TrackedMover> movers;
  for (const Track& track : tracks_) {
    if (!confirmed(track)) continue;
    const double age_s = msg::minus_s(track.now_ns, track.first_ns);
    movers.push_back({track.id, track.extent(0), track.velocity(), age_s, track.unseen_s()});
  }
  return movers;
}

}  // namespace rtd::filter
