// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/page_messages.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/unit/bus/random_message.hpp"

namespace rtd::viewer {
namespace {

std::string hex(const Bytes& bytes) {
  std::string text;
  for (const std::byte byte : bytes) fmt::format_to(std::back_inserter(text), "{:02x}", std::to_integer<int>(byte));
  return text;
}

template <class T>
T sample(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  T message{};
  bus::reflect::randomize(message, random);
  return message;
}

/// Of four pixels, two of them moving.
msg::Image mask() {
  auto image = sample<msg::Image>(1);
  image.width = image.height = image.step = 2;
  image.encoding = "mono8";
  image.data = {0, 255, 255, 0};
  return image;
}

msg::FeatureFrame features() {
  auto frame = std::make_unique<msg::FeatureFrame>(sample<msg::FeatureFrame>(2));
  frame->count = 2;
  return *frame;
}

std::string map_messages() {
  const MirroredKeyframe first{.points_m = {{1, 2, 3}, {4, 5, 6}}, .covisible = {0}};
  const page::KeyframeRef keyframes[] = {{7, &first}};
  const std::uint32_t ids[] = {3, 9};
  const TrajectoryPoint path[] = {{7, {1, 0, 0}}, {TrajectoryPoint::kNone, {2, 0, 0}}};
  const Eigen::Vector3f truth[] = {{1, 2, 3}};
  const TrajectoryPoint valued[] = {
      {.stamp_ns = 3'000'000'000, .sigma_m = 0.5F, .state = msg::TrackingState::kDoubtful}};
  const float errors_m[] = {0.25F};
  return fmt::format("trajectory_values {}\n", hex(page::trajectory_values(1, 0, 1'000'000'000, valued, errors_m))) +
         fmt::format("poses {}\nremoved {}\npoints {}\ncovisibility {}\nloop_edges {}\ntrajectory {}\ntruth {}\n",
                     hex(page::poses(1, 2, keyframes)), hex(page::removed(1, ids)),
                     hex(page::points(1, 2, keyframes, 1)), hex(page::covisibility(1, keyframes)),
                     hex(page::loop_edges(1, ids)), hex(page::trajectory(1, 0, path)), hex(page::truth(1, 0, truth)));
}

msg::OccupancyGrid floor_plan() {
  msg::OccupancyGrid plan;
  plan.info.resolution = 0.5F;
  plan.info.width = 3;
  plan.info.height = 1;
  plan.info.origin = {{1, 2, 3}, {0, 0, 0, 1}};
  plan.data = {0, 100, -1};
  return plan;
}

std::string image_messages() {
  const std::array<std::byte, 9> points{};
  return fmt::format("image {}\nfeatures {}\nmask {}\ndense {}\n", hex(page::image(1, sample<msg::CompressedImage>(3))),
                     hex(page::features(1, features())), hex(page::mask(1, mask())),
                     hex(page::dense(page::Kind::kDense, 1, 0, 1, {1, 2, 3}, 0.5F, points))) +
         fmt::format("moving {}\nplan {}\n", hex(page::dense(page::Kind::kMoving, 1, 0, 1, {1, 2, 3}, 0.5F, points)),
                     hex(page::plan(1, floor_plan()))) +
         fmt::format("depth {}\n", hex(page::image(1, sample<msg::CompressedImage>(3), page::Kind::kDepth)));
}

/// One robot that has met and one that has not.
msg::AtlasState atlas() {
  msg::AtlasState state;
  state.robots = {{.name = "anna", .met = true}, {.name = "bert"}};
  state.robots[0].T_map_robot = {{1, 2, 3}, {0, 0, 0, 1}};
  state.robots[0].T_map_camera = {{4, 5, 6}, {0, 0, 1, 0}};
  return state;
}

std::string texts() {
  const page::ServiceLine line{sample<msg::ServiceStatus>(4), 12.5};
  const CommandInfo command{"/slam/reset", ArgumentKind::kNone};
  const std::string robots[] = {"", "anna"};
  std::string all;
  for (const std::string& text :
       {page::tracking(1, sample<msg::TrackingResult>(5), 3.5, std::array<float, msg::kFilterStages>{1, 2}),
        page::boxes(1, sample<msg::Detection2DArray>(6)), page::movers(1, sample<msg::Movers>(7), std::vector<bool>(9)),
        page::playback(1, {.position_s = 1, .length_s = 2}), page::services(1, std::span(&line, 1)),
        page::commands(1, std::span(&command, 1)), page::truth_error(1, 0.25, 10), page::map_reset(1),
        page::robots(robots), page::answer(5, {true, "done"}), page::atlas(atlas())})
    all += text + '\n';
  return all;
}

/// Programs and pages of earlier versions read them. RTD_RECORD_GOLDEN=1 writes them down after a change on purpose.
TEST(PageMessages, are_the_recorded_ones) {
  const std::string now = map_messages() + image_messages() + texts();
  if (std::getenv("RTD_RECORD_GOLDEN") != nullptr) std::ofstream(GOLDEN_PATH) << now;
  std::ifstream file(GOLDEN_PATH);
  EXPECT_EQ(now, std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace
}  // namespace rtd::viewer
