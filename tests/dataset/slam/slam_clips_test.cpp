// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/vision/samples.hpp"
#include "services/slam/core/store/map_store.hpp"
#include "tests/support/clip_uri.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

OfflineReport run_clip(const std::string& source, const std::string& mode) {
  OfflineOptions options;
  options.source = source;
  options.front_end.mode = mode;
  return run_offline(options);
}

/// On the published median: what an unlucky run or another processor may add.
constexpr double kSlack = 1.3;

struct MaskedClip {
  const char* name;
  double median_ate_m;  ///< of docs/results.md, "Accuracy"
};
void PrintTo(const MaskedClip& masked, std::ostream* out) {
  *out << masked.name;
}

class TrueMaskClip : public ::testing::TestWithParam<MaskedClip> {};

/// The backend alone: what remains when the filter is perfect.
TEST_P(TrueMaskClip, is_tracked_as_well_as_by_orb_slam2) {
  const std::string source = clip_uri(GetParam().name, "?masks=1");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no " << GetParam().name;
  const OfflineReport report = run_clip(source, "true-mask");
  EXPECT_LE(report.ate_rmse_m, kSlack * GetParam().median_ate_m);
  EXPECT_GE(report.coverage, 0.99);
}
// ORB-SLAM2 with the same masks: 0.0041, 0.0087, 0.0023, 0.019 to 0.022, 0.0173 to 0.0178 m.
INSTANTIATE_TEST_SUITE_P(Clips, TrueMaskClip,
                         ::testing::Values(MaskedClip{"walk_xyz", 0.0029}, MaskedClip{"walk_rpy", 0.0057},
                                           MaskedClip{"walk_box", 0.0020}, MaskedClip{"kinect_half", 0.0121},
                                           MaskedClip{"kinect_rpy", 0.0132}));

class FaultySensorClip : public ::testing::TestWithParam<MaskedClip> {};

/// A sensor with a Kinect's faults, and three people in its view.
TEST_P(FaultySensorClip, is_tracked_with_the_real_detector) {
  const std::string source = clip_uri(GetParam().name, "?masks=1");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no " << GetParam().name;
  if (std::getenv("RTD_MODEL_DIR") == nullptr) GTEST_SKIP() << "RTD_MODEL_DIR is not set";
  const OfflineReport report = run_clip(source, "rtd");
  EXPECT_LE(report.ate_rmse_m, kSlack * GetParam().median_ate_m);
  EXPECT_GE(report.coverage, 1.0);
}
INSTANTIATE_TEST_SUITE_P(Clips, FaultySensorClip,
                         ::testing::Values(MaskedClip{"kinect_half", 0.0114}, MaskedClip{"kinect_rpy", 0.0137}));

class SlowCameraClip : public ::testing::TestWithParam<MaskedClip> {};

/// Every sixth frame: 5 Hz, so that people and camera move up to half a metre between two frames. The clips are short
/// then: the median of three runs, with other first frames.
TEST_P(SlowCameraClip, is_tracked_at_5_Hz) {
  OfflineOptions options;
  options.source = clip_uri(GetParam().name, "?masks=1");
  if (options.source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no " << GetParam().name;
  if (std::getenv("RTD_MODEL_DIR") == nullptr) GTEST_SKIP() << "RTD_MODEL_DIR is not set";
  options.front_end.mode = "rtd";
  options.frame_step = 6;
  std::vector<double> errors_m;
  for (const std::size_t first : {0, 2, 4}) {
    options.first_frame = first;
    const OfflineReport report = run_offline(options);
    EXPECT_GE(report.coverage, 1.0);
    errors_m.push_back(report.ate_rmse_m);
  }
  EXPECT_LE(vision::median(errors_m), kSlack * GetParam().median_ate_m);
}
INSTANTIATE_TEST_SUITE_P(Clips, SlowCameraClip,
                         ::testing::Values(MaskedClip{"walk_xyz", 0.0023}, MaskedClip{"walk_rpy", 0.0058},
                                           MaskedClip{"kinect_half", 0.0146}, MaskedClip{"kinect_rpy", 0.0234}));

TEST(StaticClip, fr1_xyz_is_tracked_at_5_Hz) {
  OfflineOptions options;
  options.source = clip_uri("fr1_xyz");
  if (options.source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no fr1_xyz";
  options.front_end.mode = "off";
  options.frame_step = 6;
  const OfflineReport report = run_offline(options);
  EXPECT_LE(report.ate_rmse_m, kSlack * 0.0101);
  EXPECT_GE(report.coverage, 1.0);
}

TEST(StaticClip, fr1_xyz_is_tracked_as_well_as_by_orb_slam2) {
  const std::string source = clip_uri("fr1_xyz");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no fr1_xyz";
  const OfflineReport report = run_clip(source, "off");
  EXPECT_LE(report.ate_rmse_m, 0.0094);  // ORB-SLAM2: 0.0098
  EXPECT_GE(report.coverage, 0.99);
  EXPECT_LE(report.rpe_rot_rmse_deg, 1.5);
}

TEST(StaticClip, same_clip_gives_the_same_bytes) {
  OfflineOptions options;
  options.source = clip_uri("fr1_xyz");
  if (options.source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no fr1_xyz";
  options.max_frames = 80;
  EXPECT_EQ(run_offline(options).trajectory_tum, run_offline(options).trajectory_tum);
}

TEST(DynamicClip, walk_xyz_without_filter_fails_as_orb_slam2_does) {
  const std::string source = clip_uri("walk_xyz");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no walk_xyz";
  OfflineOptions options;
  options.source = source;
  options.front_end.mode = "off";
  options.slam.witness.used = false;  // with them 0.08 m
  options.slam.tracker.inertia_m_s2 = 0;
  EXPECT_GT(run_offline(options).ate_rmse_m, 0.1);
}

/// The clips with a detector that is slow, late, gone or lying; emulated by the stamps, so that runs repeat.

/// Options for a clip below RTD_DATA_DIR; no source when it is not there.
OfflineOptions clip(const std::string& name, const std::string& mode) {
  OfflineOptions options;
  options.front_end.mode = mode;
  options.source = clip_uri(name);
  return options;
}

struct SlowClip {
  const char* name;
  double ate_m;  ///< the worse of the two tests, docs/results.md "Accuracy"
};
void PrintTo(const SlowClip& slow, std::ostream* out) {
  *out << slow.name;
}

class SlowDetector : public ::testing::TestWithParam<SlowClip> {
 protected:
  static void expect_poses_hardly_change(OfflineOptions options) {
    if (options.source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no " << GetParam().name;
    if (std::getenv("RTD_MODEL_DIR") == nullptr) GTEST_SKIP() << "RTD_MODEL_DIR is not set";
    const OfflineReport report = run_offline(options);
    EXPECT_LE(report.ate_rmse_m, 1.3 * GetParam().ate_m);
    EXPECT_GE(report.coverage, 1.0);
  }
};
INSTANTIATE_TEST_SUITE_P(Clips, SlowDetector,
                         ::testing::Values(SlowClip{"walk_xyz", 0.0024}, SlowClip{"walk_rpy", 0.0072},
                                           SlowClip{"walk_box", 0.0015}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_P(SlowDetector, at_5_hz_and_80_ms_late_hardly_changes_the_poses) {
  OfflineOptions options = clip(GetParam().name, "rtd");
  options.front_end.detector.rate_hz = 5;
  options.front_end.detector.delay_ms = 80;
  expect_poses_hardly_change(options);
}

TEST_P(SlowDetector, gone_for_a_second_hardly_changes_the_poses) {
  OfflineOptions options = clip(GetParam().name, "rtd");
  options.front_end.detector.outages = {{1.5, 2.5}};
  expect_poses_hardly_change(options);
}

class LyingDetector : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  static void SetUpTestSuite() {
    if (!clip("fr1_xyz", "off").source.empty()) off_ate_m_ = run_offline(clip("fr1_xyz", "off")).ate_rmse_m;
  }
  static inline double off_ate_m_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Seeds, LyingDetector, ::testing::Range<std::uint64_t>(1, 6));

TEST_P(LyingDetector, does_not_lead_the_camera_astray) {
  OfflineOptions lying = clip("fr1_xyz", "rtd");
  if (lying.source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no fr1_xyz";
  lying.front_end.detector.kind = "lying";
  lying.front_end.detector.seed = GetParam();
  const OfflineReport report = run_offline(lying);
  EXPECT_LE(report.ate_rmse_m, 1.6 * off_ate_m_);
  EXPECT_EQ(report.coverage, 1.0);
}

/// Save, restart, localise only: the same way again in the map of the first time.

struct Session {
  const char* name;
  const char* source;  ///< a clip below RTD_DATA_DIR, or the URI of a synthetic scene
  const char* mode;
};
void PrintTo(const Session& session, std::ostream* out) {
  *out << session.name;
}

/// The URI; empty when the clip is not there.
std::string uri_of(const std::string& source) {
  if (source.find(':') != std::string::npos) return source;
  return clip_uri(source);
}

io::Bytes save(const slam::SlamSystem& slam) {
  io::MemorySink file;
  slam.read_map([&](const slam::Map& map) { slam::write_map(slam::take_snapshot(map), file); });
  return file.bytes();
}

class SavedMap : public ::testing::TestWithParam<Session> {};

TEST_P(SavedMap, gives_the_second_session_its_poses) {
  OfflineOptions options;
  options.source = uri_of(GetParam().source);
  if (options.source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no " << GetParam().source;
  options.front_end.mode = GetParam().mode;
  options.max_frames = 100;
  io::Bytes file, file_after;
  options.on_end = [&](slam::SlamSystem& slam) { file = save(slam); };
  const OfflineReport mapping = run_offline(options);

  options.slam.localize_only = true;
  options.on_start = [&](slam::SlamSystem& slam) { slam.restore(slam::read_map(io::MemorySource(file))); };
  options.on_end = [&](slam::SlamSystem& slam) { file_after = save(slam); };
  std::size_t frames_before_pose = 0;
  bool found = false;
  options.on_frame = [&](const slam::SlamOutput& output) {
    found = found || output.result.state == msg::TrackingState::kOk;
    frames_before_pose += found ? 0 : 1;
  };
  const OfflineReport localising = run_offline(options);
  std::printf("%s: %.1f MB, mapping ATE %.4f m, localising %.4f m, first pose behind %zu frames, coverage %.3f\n",
              GetParam().name, static_cast<double>(file.size()) * 1e-6, mapping.ate_rmse_m, localising.ate_rmse_m,
              frames_before_pose, localising.coverage);
  constexpr std::size_t kFramesOfASecond = 30;
  EXPECT_LE(frames_before_pose, kFramesOfASecond);
  EXPECT_LE(localising.ate_rmse_m, 1.2 * mapping.ate_rmse_m);
  EXPECT_GE(localising.coverage, 0.95);
  EXPECT_TRUE(file_after == file) << "the map changed";
}
INSTANTIATE_TEST_SUITE_P(Sessions, SavedMap,
                         ::testing::Values(Session{"fr1_xyz", "fr1_xyz", "off"},
                                           Session{"walk_xyz", "walk_xyz", "geometry"},
                                           Session{"room", "synthetic:office?frames=90&seed=4", "geometry"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace rtd::test_support
