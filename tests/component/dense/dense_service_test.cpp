// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/dense_service.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/geometry/ply.hpp"
#include "common/service/config.hpp"
#include "tests/support/service_fixture.hpp"
#include "tests/unit/dense/wall_scene.hpp"

namespace rtd::dense {
namespace {

using test::WallScene;
using test_support::Inbox;
using test_support::ServiceFixture;
using testing::HasSubstr;

const cv::Rect kPerson{60, 30, 40, 80};

/// A camera, a filter and a slam around one dense service that runs in a thread.
class DenseServiceTest : public ServiceFixture<DenseService> {
 protected:
  void SetUp() override {
    frames_ = bus_->writer(bus::topics::kFrame);
    results_ = bus_->writer(bus::topics::kTracking);
    events_ = bus_->writer(bus::topics::kKeyframes);
    config_.every = 1;
    config_.core = WallScene::config();
  }
  void with_filter() { masks_ = bus_->writer(bus::topics::kDynamicMask); }
  void start() { ServiceFixture::start(service::Pace::kLockstep); }
  bool wait_at_least(const std::string& name, double value) {
    return states_.wait(
        [&](const auto& all) { return !all.empty() && metric(*all.back(), name).value_or(-1) >= value; });
  }
  /// One frame with the person in it, its mask (when there is a filter) and its pose.
  void send(std::uint64_t seq, std::uint32_t map_id = 0) {
    const vision::RgbdImage image = scene_.render(kPerson);
    const auto frame = std::make_unique<msg::RgbdFrame>();
    *frame = {};
    frame->seq = seq;
    frame->stamp_ns = static_cast<std::int64_t>(seq) * 33'333'333;
    const auto& p = image.camera.parameters();
    frame->intrinsics = {p.fx, p.fy, p.cx, p.cy};
    frame->depth_scale_m = image.depth_scale_m;
    frame->width = WallScene::kWidth;
    frame->height = WallScene::kHeight;
    std::memcpy(frame->color_bgr.data(), image.color_bgr.data, image.color_bgr.total() * 3);
    std::memcpy(frame->depth.data(), image.depth.data, image.depth.total() * 2);
    frames_.write(*frame);
    if (masks_) send_mask(frame->stamp_ns);
    msg::TrackingResult result{};
    result.seq = seq;
    result.stamp_ns = frame->stamp_ns;
    result.state = msg::TrackingState::kOk;
    result.map_id = map_id;
    result.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
    results_.write(result);
  }
  void send_mask(std::int64_t stamp_ns) {
    const DynamicMask mask = WallScene::mask(kPerson);
    msg::Image message;
    message.header.stamp = msg::to_time(stamp_ns);
    message.width = message.step = static_cast<std::uint32_t>(mask.columns);
    message.height = static_cast<std::uint32_t>(mask.rows);
    message.encoding = "mono8";
    message.data = mask.cells;
    masks_.write(message);
  }
  void send_and_wait(std::uint64_t count) {
    for (std::uint64_t seq = 0; seq < count; ++seq) {
      send(seq);
      ASSERT_TRUE(wait_at_least("frames", static_cast<double>(seq + 1)));
    }
  }

  WallScene scene_;
  bus::Writer<msg::RgbdFrame> frames_;
  bus::Writer<msg::TrackingResult> results_;
  bus::Writer<msg::KeyframeEvent> events_;
  bus::Writer<msg::Image> masks_;
};

float depth_of_nearest(const msg::PointCloud2& cloud) {
  float nearest_m = 100, z = 0;
  for (std::size_t i = 0; i < cloud.width; ++i) {
    std::memcpy(&z, cloud.data.data() + i * cloud.point_step + 8, 4);
    nearest_m = std::min(nearest_m, z);
  }
  return nearest_m;
}

TEST_F(DenseServiceTest, publishes_the_wall_without_the_person_and_writes_it) {
  Inbox<msg::PointCloud2> clouds;
  receive(bus::topics::kDensePoints, clouds);
  config_.publish_period_ms = 100;
  config_.out_dir = (folder_ / "run").string();
  with_filter();
  start();
  send_and_wait(3);
  ASSERT_TRUE(clouds.wait([](const auto& all) { return !all.empty() && all.back()->width > 5000; }));
  EXPECT_EQ(clouds.all().back()->header.frame_id, "map");
  EXPECT_GT(depth_of_nearest(*clouds.all().back()), 2.8F);
  EXPECT_EQ(stop(), service::kOk);
  std::ifstream file(folder_ / "run" / "static_map.ply", std::ios::binary);
  EXPECT_GT(geometry::ply_vertices(file).value_or(0), 5000U);
}

TEST_F(DenseServiceTest, writes_the_masks_of_keyframes_that_slam_names_after_later_frames) {
  config_.out_dir = folder_.string();
  with_filter();
  start();
  send_and_wait(3);
  msg::KeyframeEvent event{};
  event.frame_seq = 1;
  event.stamp_ns = 33'333'333;
  event.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
  events_.write(event);
  send(3);
  ASSERT_TRUE(wait_at_least("frames", 4));
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "masks" / "0.033333.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "masks" / "0.066666.png"));
}

TEST_F(DenseServiceTest, publishes_a_floor_plan_when_it_changes_and_writes_maps_for_navigation) {
  Inbox<msg::OccupancyGrid> plans;
  receive(bus::topics::kOccupancyGrid, plans);
  config_.grid.publish_period_ms = 100;
  config_.grid.core.find_floor = false;
  config_.grid.core.floor_m = -1;
  config_.out_dir = folder_.string();
  with_filter();
  start();
  send_and_wait(4);
  ASSERT_TRUE(plans.wait([](const auto& all) {
    return !all.empty() && std::ranges::count(all.back()->data, std::int8_t{100}) > 50 &&
           std::ranges::count(all.back()->data, std::int8_t{0}) > 500;
  }));
  const msg::OccupancyGrid plan = *plans.all().back();
  EXPECT_EQ(plan.header.frame_id, "map");
  EXPECT_EQ(plan.data.size(), std::size_t{plan.info.width} * plan.info.height);
  EXPECT_FLOAT_EQ(plan.info.resolution, 0.05F);
  EXPECT_NEAR(plan.info.origin.position.y, 1, 1e-9) << "on the floor, 1 m below the first camera, whose y is down";
  const msg::Quaternion& q = plan.info.origin.orientation;  // a quarter turn about x takes z of the plan to -y
  EXPECT_NEAR(q.x, std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(q.w, std::sqrt(0.5), 1e-9);
  EXPECT_EQ(stop(), service::kOk);
  for (const char* name : {"map.pgm", "map.yaml", "map.bt"}) {
    EXPECT_GT(std::filesystem::file_size(folder_ / name), 50U) << name;
  }
}

TEST_F(DenseServiceTest, shows_nothing_while_the_camera_is_in_another_map) {
  Inbox<msg::PointCloud2> clouds;
  Inbox<msg::OccupancyGrid> plans;
  receive(bus::topics::kDensePoints, clouds);
  receive(bus::topics::kOccupancyGrid, plans);
  config_.publish_period_ms = config_.grid.publish_period_ms = 100;
  config_.grid.core.find_floor = false;
  config_.grid.core.floor_m = -1;
  with_filter();
  start();
  send_and_wait(4);
  const auto free = [](const auto& all) { return std::ranges::count(all.back()->data, std::int8_t{0}); };
  const auto shown = [&](bool anything) {
    return clouds.wait([=](const auto& all) { return !all.empty() && (all.back()->width > 0) == anything; }) &&
           plans.wait([=](const auto& all) { return !all.empty() && (free(all) > 0) == anything; });
  };
  ASSERT_TRUE(shown(true));
  const std::size_t cells = plans.all().back()->data.size();
  send(4, 1);
  ASSERT_TRUE(shown(false));
  EXPECT_EQ(std::ranges::count(plans.all().back()->data, std::int8_t{-1}), cells) << "the plan is taken back";
  send(5, 0);
  EXPECT_TRUE(shown(true)) << "both maps are one now";
}

TEST_F(DenseServiceTest, fails_when_a_map_for_navigation_cannot_be_written) {
  std::filesystem::create_directories(folder_ / "map.bt");  // a folder of that name
  config_.out_dir = folder_.string();
  with_filter();
  start();
  send_and_wait(2);
  EXPECT_EQ(stop(), service::kRunFailed);
}

TEST_F(DenseServiceTest, reports_that_its_floor_plan_is_full) {
  config_.grid.core.space.max_blocks = 10;
  with_filter();
  start();
  send(0);
  EXPECT_TRUE(wait_state(msg::ServiceState::kDegraded, "dense.grid.max_blocks"));
}

TEST_F(DenseServiceTest, fuses_nothing_without_masks_and_reports_it) {
  start();
  std::uint64_t seq = 0;
  for (; seq < 10; ++seq) send(seq);
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded, "no masks"));
  for (; seq < 15; ++seq) send(seq);  // the last ones wait for their masks, and a busy host may lose an image
  EXPECT_TRUE(wait_at_least("frames_without_mask", 5));
  const auto last = states_.all().back();
  for (const msg::Metric& metric : last->metrics) EXPECT_TRUE(metric.name != "frames" || metric.value == 0);
}

TEST_F(DenseServiceTest, fuses_everything_without_masks_when_configured) {
  config_.without_masks = true;
  start();
  for (std::uint64_t seq = 0; seq < 10; ++seq) send(seq);
  EXPECT_TRUE(wait_at_least("frames", 5));
}

TEST_F(DenseServiceTest, works_off_what_has_come_before_it_ends) {
  config_.out_dir = folder_.string();
  with_filter();
  start();
  for (std::uint64_t seq = 0; seq < 8; ++seq) send(seq);
  ASSERT_TRUE(wait_at_least("frames", 2));  // seen twice: given out
  EXPECT_EQ(stop(), service::kOk);
  std::ifstream file(folder_ / "static_map.ply", std::ios::binary);
  EXPECT_GT(geometry::ply_vertices(file).value_or(0), 5000U);
}

TEST_F(DenseServiceTest, never_holds_up_a_camera_that_is_faster) {
  with_filter();
  start();
  for (std::uint64_t seq = 0; seq < 60; ++seq) send(seq);
  ASSERT_TRUE(wait_at_least("frames", 5)) << "newest wins, and no service waited";
}

TEST_F(DenseServiceTest, reports_that_its_map_is_full) {
  config_.core.fusion.max_voxels = 1000;
  with_filter();
  start();
  send(0);
  EXPECT_TRUE(wait_state(msg::ServiceState::kDegraded, "map full"));
}

TEST_F(DenseServiceTest, fails_when_the_file_cannot_be_written) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "file") << "not a folder";
  config_.out_dir = (folder_ / "file").string();
  with_filter();
  start();
  EXPECT_EQ(stop(), service::kRunFailed);
}

TEST(DenseConfig, is_bound_completely_and_refuses_what_is_out_of_range) {
  ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("dense", config);
  binder.set("dense.fusion.voxel_m=0.05");
  EXPECT_DOUBLE_EQ(config.core.fusion.voxel_m, 0.05);
  EXPECT_THROW(binder.set("dense.fusion.voxel_m=0"), service::ConfigError);
  EXPECT_THROW(binder.set("dense.every=0"), service::ConfigError);
  EXPECT_TRUE(make_navigation(config.grid).has_value());
  for (const char* up : {"0,0", "a,b,c", "0,0,0", "0,0,1,2", "nan,0,1", "0;0;1"}) {
    config.grid.up = up;
    EXPECT_THAT([&] { make_navigation(config.grid); },
                testing::ThrowsMessage<service::ConfigError>(HasSubstr("dense.grid.up")))
        << up;
  }
  EXPECT_THAT([&] { binder.set("dense.carving.margn_m=1"); },
              testing::ThrowsMessage<service::ConfigError>(HasSubstr("margin_m")));
}

}  // namespace
}  // namespace rtd::dense
