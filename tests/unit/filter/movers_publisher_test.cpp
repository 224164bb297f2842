// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/movers_publisher.hpp"

#include <gtest/gtest.h>

#include "common/bus/bus_factory.hpp"
#include "tests/support/inbox.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::filter {
namespace {

WorldMover walker() {
  WorldMover mover;
  mover.id = 7;
  mover.class_name = "person";
  mover.score = 0.8;
  mover.extent_world = {Eigen::Vector3d(1, 2, 0), Eigen::Vector3d(1.5, 2.4, 1.8)};
  mover.velocity_world_m_s = {0.5, -1, 0};
  mover.covariance = 0.01 * Matrix6d::Identity();
  mover.covariance(0, 1) = mover.covariance(1, 0) = 0.002;
  mover.static_probability = 0.2;
  return mover;
}

constexpr std::int64_t kStampNs = 12'345'678'901;

TEST(MoverBoxes, carry_number_class_place_size_and_covariance) {
  const msg::Detection3DArray boxes = make_boxes({walker()}, kStampNs, "anna/map");
  EXPECT_EQ(boxes.header.frame_id, "anna/map");
  EXPECT_EQ(msg::to_ns(boxes.header.stamp), kStampNs);
  ASSERT_EQ(boxes.detections.size(), 1U);
  const msg::Detection3D& box = boxes.detections[0];
  EXPECT_EQ(box.id, "7");
  EXPECT_EQ(box.header.frame_id, "anna/map");
  EXPECT_DOUBLE_EQ(box.bbox.center.position.x, 1.25);
  EXPECT_DOUBLE_EQ(box.bbox.center.position.z, 0.9);
  EXPECT_DOUBLE_EQ(box.bbox.center.orientation.w, 1);
  EXPECT_DOUBLE_EQ(box.bbox.size.z, 1.8);
  ASSERT_EQ(box.results.size(), 1U);
  EXPECT_EQ(box.results[0].hypothesis.class_id, "person");
  EXPECT_DOUBLE_EQ(box.results[0].hypothesis.score, 0.8);
  EXPECT_DOUBLE_EQ(box.results[0].pose.pose.position.y, 2.2);
  EXPECT_DOUBLE_EQ(box.results[0].pose.covariance[0], 0.01);
  EXPECT_DOUBLE_EQ(box.results[0].pose.covariance[1], 0.002);
  EXPECT_GT(box.results[0].pose.covariance[35], 3) << "rad^2: any heading";
  EXPECT_DOUBLE_EQ(box.results[0].pose.covariance[3], 0);
}

TEST(MoverBoxes, of_what_has_no_class_are_unknown) {
  WorldMover mover = walker();
  mover.class_name.clear();
  EXPECT_EQ(make_boxes({mover}, kStampNs, "map").detections[0].results[0].hypothesis.class_id, "unknown");
  EXPECT_TRUE(make_boxes({}, kStampNs, "map").detections.empty());
}

const msg::Header kHeader{msg::to_time(kStampNs), "map"};

TEST(MoverMarkers, are_a_box_a_name_and_an_arrow_each) {
  WorldMover hidden = walker();
  hidden.id = 8;
  hidden.unseen_s = 0.4;
  const msg::MarkerArray markers = make_markers({walker(), hidden}, {false, false}, kHeader);
  ASSERT_EQ(markers.markers.size(), 6U);
  const msg::Marker &box = markers.markers[0], &name = markers.markers[1], &arrow = markers.markers[2];
  EXPECT_EQ(box.type, 1) << "CUBE";
  EXPECT_EQ(box.header.frame_id, "map");
  EXPECT_EQ(box.id, 7);
  EXPECT_DOUBLE_EQ(box.scale.x, 0.5);
  EXPECT_DOUBLE_EQ(box.pose.position.x, 1.25);
  EXPECT_GT(box.color.r, box.color.g) << "moves";
  EXPECT_EQ(arrow.type, 0) << "ARROW";
  ASSERT_EQ(arrow.points.size(), 2U);
  EXPECT_DOUBLE_EQ(arrow.points[1].y - arrow.points[0].y, -1);
  EXPECT_DOUBLE_EQ(arrow.pose.position.x, 0) << "its points are in the frame itself";
  EXPECT_EQ(name.type, 9) << "TEXT_VIEW_FACING";
  EXPECT_EQ(name.text, "person 7  1.1 m/s");
  EXPECT_LT(markers.markers[3].color.a, box.color.a) << "a hidden one is pale";
  for (const msg::Marker& marker : markers.markers) EXPECT_GT(marker.lifetime.nanosec, 0U) << "vanishes by itself";
}

TEST(MoverMarkers, of_what_rests_have_neither_arrow_nor_speed) {
  const msg::MarkerArray markers = make_markers({walker()}, {true}, kHeader);
  ASSERT_EQ(markers.markers.size(), 2U);
  EXPECT_EQ(markers.markers[1].text, "person 7");
}

TEST(MoversPublisher, follows_the_camera_into_another_map) {
  bus::BusOptions options;
  options.vendor = bus::inprocess::vendor();
  const auto bus = bus::connect(options);
  test_support::Inbox<msg::Detection3DArray> boxes;
  test_support::Inbox<msg::Movers> own;
  const auto box_reader = bus->reader<msg::Detection3DArray>(bus::topics::kMoverBoxes, [&](auto m) { boxes.take(m); });
  const auto own_reader = bus->reader<msg::Movers>(bus::topics::kMovers, [&](auto m) { own.take(m); });
  MoversPublisher publisher(*bus, "map");
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    publisher.add(seq, kStampNs + static_cast<std::int64_t>(seq), {});
    msg::TrackingResult result{};
    result.seq = seq;
    result.state = msg::TrackingState::kOk;
    result.map_id = seq == 1 ? 1 : 0;
    result.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
    publisher.on_result(result);
  }
  ASSERT_TRUE(boxes.wait_count(3));
  for (const auto& message : boxes.all()) EXPECT_EQ(message->header.frame_id, "map");
  ASSERT_TRUE(own.wait_count(2)) << "a type without a frame is of the first map";
  EXPECT_EQ(own.all().back()->seq, 2U);
}

}  // namespace
}  // namespace rtd::filter
