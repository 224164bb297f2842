// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Save, restart, localise only: the same way again in the map of the first time.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "services/slam/core/store/map_store.hpp"
#include "tests/support/clip_uri.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

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
