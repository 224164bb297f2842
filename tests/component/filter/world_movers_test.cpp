// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Where the filter says that objects are and how fast, against the objects of rendered scenes.
#include "services/filter/core/movers/world_movers.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "common/camera/open/source_factory.hpp"
#include "common/camera/synthetic/synthetic_source.hpp"
#include "services/filter/core/boxes/assignment.hpp"
#include "services/filter/core/dynamic_filter.hpp"

namespace rtd::filter {
namespace {

namespace synthetic = camera::synthetic;

/// The objects of a scene in the frame of its first camera.
class Truth {
 public:
  explicit Truth(const std::string& uri)
      : options_(camera::parse_synthetic_options(camera::parse_source_uri(uri))),
        scene_(options_.scene, options_.seed),
        T_first_world_(scene_.T_world_camera(0).inverse()) {}

  Eigen::AlignedBox3d extent(int object, double t_s) const {
    const synthetic::Geometry geometry = scene_.geometry_at(t_s);
    Eigen::AlignedBox3d extent;
    const auto add = [&](const Eigen::Vector3f& p) { extent.extend(T_first_world_ * p.cast<double>()); };
    for (const synthetic::Face& face : geometry.faces) {
      if (face.surface.object != object) continue;
      for (const int corner : {0, 1, 2, 3}) {
        add(face.origin + face.axis_s * (face.width_m * static_cast<float>(corner & 1)) +
            face.axis_t * (face.height_m * static_cast<float>(corner >> 1)));
      }
    }
    for (const synthetic::Ellipsoid& body : geometry.ellipsoids) {
      if (body.surface.object != object) continue;
      for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0F, 1.0F})
          add(body.T_world_body * (side * body.semi_axes_m[axis] * Eigen::Vector3f::Unit(axis)));
      }
    }
    return extent;
  }
  /// Of its largest part: what a person does, not what the limbs do.
  Eigen::Vector3d velocity(int object, double t_s) const {
    constexpr double kStepS = 0.1;
    return (middle(object, t_s + kStepS) - middle(object, t_s - kStepS)) / (2 * kStepS);
  }
  /// Without what is vertical: the feet of people are mostly not in the image.
  Eigen::Vector2d horizontal(const Eigen::Vector3d& v_first) const {
    return (T_first_world_.linear().transpose() * v_first).head<2>();
  }
  Eigen::Matrix2d horizontal_covariance(const Eigen::Matrix3d& covariance_first) const {
    const Eigen::Matrix3d turn = T_first_world_.linear().transpose();
    return (turn * covariance_first * turn.transpose()).topLeftCorner<2, 2>();
  }
  Eigen::Isometry3d T_first_camera(const Eigen::Isometry3d& T_world_camera) const {
    return T_first_world_ * T_world_camera;
  }
  double fps() const { return options_.fps; }

 private:
  Eigen::Vector3d middle(int object, double t_s) const {
    const synthetic::Geometry geometry = scene_.geometry_at(t_s);
    const synthetic::Ellipsoid* largest = nullptr;
    for (const synthetic::Ellipsoid& body : geometry.ellipsoids) {
      if (body.surface.object != object) continue;
      if (largest == nullptr || body.semi_axes_m.prod() > largest->semi_axes_m.prod()) largest = &body;
    }
    if (largest == nullptr) return extent(object, t_s).center();
    return T_first_world_ * largest->T_world_body.translation().cast<double>();
  }

  camera::SyntheticOptions options_;
  synthetic::Scene scene_;
  Eigen::Isometry3d T_first_world_;
};

struct Accuracy {
  std::size_t seen = 0, found = 0;  ///< objects of frames that are wholly in view
  double position_rmse_m = 0, velocity_rmse_m_s = 0;
  double position_nees = 0, velocity_nees = 0;  ///< for each number: 1 where the covariance is right
  double visible_min = 0, apart_min = 0;        ///< object-minutes in which changes of id count; of objects apart
  int id_switches = 0, id_switches_apart = 0;
};

/// Counts changes of id as CLEAR MOT does (Bernardin and Stiefelhagen 2008): each object that is 1 to 4 m away with
/// 3000 visible pixels has one mover within 0.5 m, the one it had before if that is still there, else the nearest that
/// is seen and free. An object that was not there for a second starts again.
class IdSwitches {
 public:
  /// Returns the objects that have another id now.
  std::vector<int> add(std::uint64_t frame, const std::vector<int>& objects, const std::vector<WorldMover>& movers,
                       const std::function<double(int, const WorldMover&)>& apart_m) {
    std::vector<int> mover_of(objects.size(), -1);
    std::vector<char> taken(movers.size(), 0);
    CostMatrix costs(static_cast<int>(objects.size()), static_cast<int>(movers.size()));
    for (std::size_t i = 0; i < objects.size(); ++i) {
      Known& known = known_[objects[i]];
      if (known.id && frame > known.frame + kAwayFrames) known.id.reset();
      known.frame = frame;
      for (std::size_t j = 0; j < movers.size() && known.id; ++j) {
        if (movers[j].id != *known.id || taken[j] != 0 || apart_m(objects[i], movers[j]) > kGateM) continue;
        mover_of[i] = static_cast<int>(j);
        taken[j] = 1;
      }
    }
    for (std::size_t i = 0; i < objects.size(); ++i) {
      for (std::size_t j = 0; j < movers.size(); ++j) {
        const bool free = mover_of[i] < 0 && taken[j] == 0 && movers[j].unseen_s <= 0;
        if (free) costs.at(static_cast<int>(i), static_cast<int>(j)) = apart_m(objects[i], movers[j]);
      }
    }
    const std::vector<int> others = assign(costs, kGateM);
    std::vector<int> switched;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (others[i] < 0) continue;
      Known& known = known_[objects[i]];
      if (known.id) switched.push_back(objects[i]);
      known.id = movers[static_cast<std::size_t>(others[i])].id;
    }
    return switched;
  }

 private:
  struct Known {
    std::optional<std::uint32_t> id;
    std::uint64_t frame = 0;
  };
  static constexpr double kGateM = 0.5;
  static constexpr std::uint64_t kAwayFrames = 30;
  std::map<int, Known> known_;
};

/// Rendered objects pass through each other, which no tracker can follow and real ones cannot do. An object is apart
/// when no other one has been within 0.45 m of its middle for a second and a half.
class Apart {
 public:
  void add(std::uint64_t frame, const std::map<int, Eigen::Vector2d>& middles) {
    constexpr double kTouchM = 0.45;
    frame_ = frame;
    for (const auto& [a, middle_a] : middles) {
      for (const auto& [b, middle_b] : middles) {
        if (a != b && (middle_a - middle_b).norm() < kTouchM) touched_[a] = frame;
      }
    }
  }
  bool is_apart(int object) const {
    constexpr std::uint64_t kSinceFrames = 45;
    const auto touched = touched_.find(object);
    return touched == touched_.end() || frame_ > touched->second + kSinceFrames;
  }

 private:
  std::uint64_t frame_ = 0;
  std::map<int, std::uint64_t> touched_;
};

/// No other person in front of it, and not cut off by the border of the image but at its feet.
bool is_in_view(const camera::SourceFrame& frame, const camera::SourceObject& object) {
  constexpr int kMarginPx = 12;
  const cv::Size size = frame.image.color_bgr.size();
  const cv::Rect inside(kMarginPx, kMarginPx, size.width - 2 * kMarginPx, size.height - kMarginPx);
  if ((object.box_px & inside) != object.box_px || object.visible_px < 4000) return false;
  for (const camera::SourceObject& other : frame.objects) {
    if (other.id != object.id && other.class_name != "chair" && (other.box_px & object.box_px).area() > 0) return false;
  }
  return true;
}

/// Two thirds of a second after it has come into view alone: a velocity needs some frames.
constexpr int kSettled = 20;

/// A detector that misses nothing but the small.
std::vector<vision::Detection> boxes_of(const camera::SourceFrame& frame) {
  std::vector<vision::Detection> boxes;
  for (const camera::SourceObject& object : frame.objects) {
    if (object.class_name == "box" || object.visible_px < 900) continue;
    const cv::Rect2f box = object.box_px;
    boxes.push_back({object.class_name, 0.9F, box.x, box.y, box.width, box.height});
  }
  return boxes;
}

/// The objects of which changes of id count: IdSwitches.
std::vector<int> countable_objects(const camera::SourceFrame& frame, const Truth& truth, double t_s,
                                   const Eigen::Vector3d& camera_position) {
  std::vector<int> objects;
  for (const camera::SourceObject& object : frame.objects) {
    const double far_m = truth.horizontal(truth.extent(object.id, t_s).center() - camera_position).norm();
    if (object.class_name != "chair" && object.visible_px >= 3000 && far_m >= 1 && far_m <= 4)
      objects.push_back(object.id);
  }
  return objects;
}

/// Where the objects are that move, on the floor.
std::map<int, Eigen::Vector2d> middles_of(const camera::SourceFrame& frame, const Truth& truth, double t_s) {
  std::map<int, Eigen::Vector2d> middles;
  for (const camera::SourceObject& object : frame.objects) {
    if (object.class_name != "chair") middles[object.id] = truth.horizontal(truth.extent(object.id, t_s).center());
  }
  return middles;
}

void print(const std::string& uri, const Accuracy& accuracy) {
  std::printf(
      "%s: %zu of %zu found, position %.3f m, velocity %.3f m/s, NEES %.2f, %.2f, %d id switches in %.2f min, "
      "%d of objects apart in %.2f min\n",
      uri.c_str(), accuracy.found, accuracy.seen, accuracy.position_rmse_m, accuracy.velocity_rmse_m_s,
      accuracy.position_nees, accuracy.velocity_nees, accuracy.id_switches, accuracy.visible_min,
      accuracy.id_switches_apart, accuracy.apart_min);
}

Accuracy measure(const std::string& uri) {
  const auto source = camera::make_source(uri);
  const Truth truth(uri);
  FilterConfig config;
  config.mode = FilterMode::kRtd;
  DynamicFilter filter(config, [] { return std::int64_t{0}; });
  WorldMovers world;
  Accuracy accuracy;
  IdSwitches ids;
  Apart apart;
  std::map<int, int> in_view_for;  // frames in a row
  double position_sum = 0, velocity_sum = 0;
  while (const auto frame = source->next()) {
    const FilterResult result = filter.apply(frame->image, boxes_of(*frame));
    const Eigen::Isometry3d T_map_camera = truth.T_first_camera(*frame->T_world_camera);
    const auto movers = world.place(frame->image.stamp_ns, T_map_camera, filter.sight_objects(frame->image, result));
    filter.on_pose({frame->image.seq, 0, T_map_camera});
    const double t_s = static_cast<double>(frame->image.seq) / truth.fps();
    const auto apart_m = [&](int object, const WorldMover& mover) {
      return truth.horizontal(mover.extent_world.center() - truth.extent(object, t_s).center()).norm();
    };
    const std::vector<int> visible = countable_objects(*frame, truth, t_s, T_map_camera.translation());
    apart.add(frame->image.seq, middles_of(*frame, truth, t_s));
    const auto is_apart = [&](int object) { return apart.is_apart(object); };
    const std::vector<int> switched = ids.add(frame->image.seq, visible, movers, apart_m);
    accuracy.id_switches += static_cast<int>(switched.size());
    accuracy.id_switches_apart += static_cast<int>(std::ranges::count_if(switched, is_apart));
    accuracy.visible_min += static_cast<double>(visible.size()) / truth.fps() / 60;
    accuracy.apart_min += static_cast<double>(std::ranges::count_if(visible, is_apart)) / truth.fps() / 60;
    for (const camera::SourceObject& object : frame->objects) {
      const bool in_view = is_in_view(*frame, object) && object.class_name != "chair";
      int& frames_in_view = in_view_for[object.id];
      frames_in_view = in_view ? frames_in_view + 1 : 0;
      if (frames_in_view < kSettled) continue;
      const Eigen::AlignedBox3d extent = truth.extent(object.id, t_s);
      const auto error_m = [&](const WorldMover& mover) { return apart_m(object.id, mover); };
      ++accuracy.seen;
      const auto nearest = std::ranges::min_element(movers, {}, error_m);
      if (nearest == movers.end() || error_m(*nearest) > 0.5) continue;
      ++accuracy.found;
      const Eigen::Vector2d off_m = truth.horizontal(nearest->extent_world.center() - extent.center());
      const Eigen::Vector2d off_m_s = truth.horizontal(nearest->velocity_world_m_s - truth.velocity(object.id, t_s));
      const Eigen::Matrix2d P_m =
          truth.horizontal_covariance(Eigen::Matrix3d(nearest->covariance.topLeftCorner<3, 3>()));
      const Eigen::Matrix2d P_m_s =
          truth.horizontal_covariance(Eigen::Matrix3d(nearest->covariance.bottomRightCorner<3, 3>()));
      accuracy.position_nees += off_m.dot(P_m.inverse() * off_m) / 2;
      accuracy.velocity_nees += off_m_s.dot(P_m_s.inverse() * off_m_s) / 2;
      position_sum += std::pow(error_m(*nearest), 2);
      velocity_sum += off_m_s.squaredNorm();
    }
  }
  accuracy.position_rmse_m = std::sqrt(position_sum / static_cast<double>(accuracy.found));
  accuracy.velocity_rmse_m_s = std::sqrt(velocity_sum / static_cast<double>(accuracy.found));
  accuracy.position_nees /= static_cast<double>(accuracy.found);
  accuracy.velocity_nees /= static_cast<double>(accuracy.found);
  print(uri, accuracy);
  return accuracy;
}

struct MoversScene {
  const char* uri;
  int id_switches = 0;  ///< of objects that pass through each other or are hidden by one that does
};

class WorldMoversIn : public ::testing::TestWithParam<MoversScene> {};

TEST_P(WorldMoversIn, scenes_are_where_and_as_fast_as_they_are) {
  const Accuracy accuracy = measure(GetParam().uri);
  EXPECT_GE(accuracy.found, accuracy.seen * 9 / 10);
  EXPECT_GT(accuracy.found, 0U);
  EXPECT_LE(accuracy.position_rmse_m, 0.15);
  EXPECT_LE(accuracy.velocity_rmse_m_s, 0.22);
  EXPECT_LE(accuracy.position_nees, 3);
  EXPECT_LE(accuracy.velocity_nees, 3);
  EXPECT_EQ(accuracy.id_switches_apart, 0);
  EXPECT_LE(accuracy.id_switches, GetParam().id_switches);
}

INSTANTIATE_TEST_SUITE_P(Scenes, WorldMoversIn,
                         ::testing::Values(MoversScene{"synthetic:office?frames=300&seed=5", 1},
                                           MoversScene{"synthetic:flicker?frames=200&seed=3"},
                                           MoversScene{"synthetic:sitting?frames=420"},
                                           MoversScene{"synthetic:box?frames=240", 1},
                                           MoversScene{"synthetic:box?frames=300&seed=63", 2},
                                           MoversScene{"synthetic:approach?frames=200"}));

}  // namespace
}  // namespace rtd::filter
