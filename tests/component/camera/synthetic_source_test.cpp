// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/synthetic_source.hpp"

#include <gmock/gmock.h>

#include "common/camera/open/source_factory.hpp"
#include "common/camera/tum/tum_export.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

using test::agreement;
using test::Agreement;
using test::play;
using test::same;
using namespace ::testing;

TEST(SyntheticSource, gives_the_same_bits_for_the_same_seed) {
  const auto first = play("synthetic:office?frames=3&seed=7"), second = play("synthetic:office?frames=3&seed=7");
  const auto other = play("synthetic:office?frames=3&seed=8");
  ASSERT_THAT(first, SizeIs(3));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(same(first[i].image.color_bgr, second[i].image.color_bgr));
    EXPECT_TRUE(same(first[i].image.depth, second[i].image.depth));
    EXPECT_TRUE(same(first[i].dynamic_mask, second[i].dynamic_mask));
    EXPECT_TRUE(first[i].T_world_camera->isApprox(*second[i].T_world_camera, 0));
  }
  EXPECT_FALSE(same(first[2].image.color_bgr, other[2].image.color_bgr));
}

TEST(SyntheticSource, stamps_frames_at_its_rate) {
  const auto frames = play("synthetic:static?frames=4&fps=10&width=64&height=48");
  EXPECT_EQ(frames[3].image.seq, 3U);
  EXPECT_EQ(frames[3].image.stamp_ns - frames[0].image.stamp_ns, 300'000'000);
  EXPECT_EQ(frames[0].image.stamp_ns % 1000, 0) << "TUM files carry microseconds";
}

TEST(SyntheticSource, poses_and_depth_agree_between_frames) {
  const auto frames = play("synthetic:office?frames=16&noise=0&seed=3");
  const Agreement all = agreement(frames.front(), frames.back(), frames.front().dynamic_mask);
  EXPECT_GT(all.pixels, 5000);
  EXPECT_GT(all.share, 0.97) << "the rest is uncovered or slanted background";
}

TEST(SyntheticSource, masked_pixels_are_those_that_moved) {
  const auto frames = play("synthetic:crowd?frames=10&noise=0&seed=3");
  cv::Mat still;
  cv::compare(frames.front().dynamic_mask, 0, still, cv::CMP_EQ);
  ASSERT_GT(cv::countNonZero(frames.front().dynamic_mask), 5000);
  EXPECT_LT(agreement(frames.front(), frames.back(), still).share, 0.5);
}

TEST(SyntheticSource, knows_the_boxes_of_its_objects) {
  bool person = false, box = false;
  for (const SourceFrame& frame : play("synthetic:office?frames=60&fps=6&width=160&height=120")) {
    cv::Mat outside = frame.dynamic_mask.clone();
    int visible = 0;
    for (const SourceObject& object : frame.objects) {
      EXPECT_TRUE(object.moving);
      ASSERT_EQ(object.box_px & cv::Rect(0, 0, 160, 120), object.box_px);
      EXPECT_LE(object.visible_px, object.box_px.area());
      outside(object.box_px).setTo(0);
      visible += object.visible_px;
      person = person || object.class_name == "person";
      box = box || object.class_name == "box";
    }
    EXPECT_EQ(visible, cv::countNonZero(frame.dynamic_mask)) << "everything that moves is an object here";
    EXPECT_EQ(cv::countNonZero(outside), 0);
  }
  EXPECT_TRUE(person && box);
}

TEST(SyntheticSource, scenes_contain_what_their_names_say) {
  const auto masked = [](const std::string& uri) {
    int pixels = 0;
    for (const SourceFrame& frame : play(uri)) pixels += cv::countNonZero(frame.dynamic_mask);
    return pixels;
  };
  const std::string few = "?frames=90&fps=3&width=160&height=120";
  const int office = masked("synthetic:office" + few), crowd = masked("synthetic:crowd" + few);
  EXPECT_EQ(masked("synthetic:static" + few), 0);
  EXPECT_EQ(masked("synthetic:tour" + few), 0);
  EXPECT_GT(masked("synthetic:box" + few), 0);
  EXPECT_GT(office, 0);
  EXPECT_GT(crowd, office);
  EXPECT_EQ(masked("synthetic:office" + few + "&people=0&boxes=0"), 0);
}

TEST(SyntheticSource, camera_stays_in_its_part_of_the_room_and_moves_like_a_hand) {
  using Room = synthetic::CameraRoom;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const synthetic::CameraPath path(synthetic::CameraMotion::kHandHeld, seed);
    for (double t_s = 0; t_s < 600; t_s += 0.5) {
      const Eigen::Isometry3d now = path.T_world_camera(t_s), next = path.T_world_camera(t_s + 1.0 / 30);
      const Eigen::Vector3d p = now.translation();
      ASSERT_TRUE(p.x() > Room::kMinX && p.x() < Room::kMaxX && p.y() > Room::kMinY && p.y() < Room::kMaxY &&
                  p.z() > Room::kMinZ && p.z() < Room::kMaxZ)
          << p.transpose();
      ASSERT_LT((next.translation() - p).norm() * 30, 1.2) << "m/s";
      ASSERT_LT(Eigen::AngleAxisd(now.linear().transpose() * next.linear()).angle() * 30, 0.6) << "rad/s";
      ASSERT_NEAR(now.linear().determinant(), 1.0, 1e-12);
    }
  }
}

TEST(SyntheticSource, every_view_is_rich_in_depth) {
  for (const SourceFrame& frame : play("synthetic:office?frames=40&fps=1")) {
    EXPECT_GT(cv::countNonZero(frame.image.depth), 640 * 480 * 3 / 4);
    EXPECT_TRUE(frame.has_depth);
  }
}

TEST(SyntheticSource, endless_source_gives_ground_truth_of_the_part_played) {
  const auto source = make_source("synthetic:static?frames=0&width=64&height=48");
  EXPECT_EQ(source->info().frames, 0U);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(source->next());
  const auto poses = source->groundtruth();
  ASSERT_THAT(poses, SizeIs(5));
  const auto sixth = source->next();
  EXPECT_LT(poses[4].stamp_ns, sixth->image.stamp_ns);
}

TEST(SyntheticSource, passes_over_frames_without_changing_the_later_ones) {
  const std::string uri = "synthetic:office?frames=6&width=64&height=48";
  const auto source = make_source(uri);
  const auto all = play(uri);
  EXPECT_EQ(source->pass_over(all[4].image.stamp_ns), 4U);
  const auto frame = source->next();
  EXPECT_EQ(frame->image.seq, 4U);
  EXPECT_TRUE(same(frame->image.color_bgr, all[4].image.color_bgr));
  EXPECT_TRUE(same(frame->image.depth, all[4].image.depth));
}

TEST(SyntheticSource, refuses_what_it_does_not_know) {
  EXPECT_THAT(
      [] { make_source("synthetic:kitchen"); },
      ThrowsMessage<SourceError>(AllOf(
          HasSubstr("'kitchen'"),
          HasSubstr("office, static, box, crowd, tour, sitting, fill, approach, slow, flicker, corridor, lookalike"))));
  EXPECT_THAT([] { make_source("synthetic:office?sed=1"); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("'sed'"), HasSubstr("seed"))));
  EXPECT_THAT([] { make_source("synthetic:office?width=2560"); }, ThrowsMessage<SourceError>(HasSubstr("[64, 1920]")));
  EXPECT_THAT([] { make_source("synthetic:office?fps=fast"); }, ThrowsMessage<SourceError>(HasSubstr("fps is 'fast'")));
  EXPECT_THAT([] { make_source("synthetic:office?frames=nan"); }, ThrowsMessage<SourceError>(HasSubstr("frames")));
}

TEST(TumExport, is_read_back_as_it_was) {
  const test::SequenceFolder folder;
  const std::string scene = "synthetic:office?frames=4&width=160&height=120&seed=5";
  const auto source = make_source(scene);
  EXPECT_EQ(export_tum(*source, folder.path() / "clip", 0), 4U);
  const auto before = play(scene), after = play("tum:" + (folder.path() / "clip").string() + "?masks=1");
  ASSERT_THAT(after, SizeIs(4));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(after[i].image.stamp_ns, before[i].image.stamp_ns);
    EXPECT_TRUE(same(after[i].image.depth, before[i].image.depth));
    EXPECT_TRUE(same(after[i].image.color_bgr, before[i].image.color_bgr));
    EXPECT_TRUE(same(after[i].dynamic_mask, before[i].dynamic_mask));
    EXPECT_NEAR(after[i].image.camera.parameters().fx, before[i].image.camera.parameters().fx, 1e-9);
  }
  const auto poses = make_source("tum:" + (folder.path() / "clip").string())->groundtruth();
  ASSERT_THAT(poses, SizeIs(4));
  EXPECT_TRUE(poses[3].T_world_body.isApprox(*before[3].T_world_camera, 1e-8));
}

TEST(TumExport, keeps_what_is_known_of_the_times_of_the_sensor) {
  const test::SequenceFolder folder;
  const auto source =
      make_source("synthetic:static?frames=1&width=64&height=48&rolling_shutter_ms=30&depth_lag_ms=8&timing=known");
  EXPECT_EQ(export_tum(*source, folder.path() / "clip", 0), 1U);
  const auto after = play("tum:" + (folder.path() / "clip").string());
  ASSERT_THAT(after, SizeIs(1));
  EXPECT_DOUBLE_EQ(after[0].image.readout_s, 0.03);
  EXPECT_DOUBLE_EQ(after[0].image.depth_offset_s, 0.008);
}

TEST(TumExport, keeps_the_stamps_of_both_images) {
  const test::SequenceFolder folder;
  folder.three_frames();
  folder.append("calibration.yaml", "depth_offset_s: 0.002\n");
  folder.write("associations.txt", "1.0 rgb/1.0.png 0.987 depth/1.0.png\n1.1 rgb/1.1.png 1.1 depth/1.1.png\n");
  const auto source = make_source(folder.uri());
  EXPECT_EQ(export_tum(*source, folder.path() / "clip", 0), 2U);
  const auto after = play("tum:" + (folder.path() / "clip").string());
  ASSERT_THAT(after, SizeIs(2));
  EXPECT_NEAR(after[0].image.depth_offset_s, -0.011, 1e-9);
  EXPECT_NEAR(after[1].image.depth_offset_s, 0.002, 1e-9);
}

TEST(TumExport, refuses_endless_sources_and_used_folders) {
  const test::SequenceFolder folder;
  const auto endless = make_source("synthetic:static?frames=0&width=64&height=48");
  EXPECT_THAT([&] { export_tum(*endless, folder.path() / "clip", 0); },
              ThrowsMessage<SourceError>(HasSubstr("--frames")));
  EXPECT_EQ(export_tum(*endless, folder.path() / "clip", 2), 2U);
  EXPECT_THAT([&] { export_tum(*endless, folder.path() / "clip", 2); },
              ThrowsMessage<SourceError>(HasSubstr("holds a sequence already")));
}

}  // namespace
}  // namespace rtd::camera
