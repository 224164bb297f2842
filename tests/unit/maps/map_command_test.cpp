// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/maps/map_command.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/occupancy/octomap_file.hpp"
#include "services/slam/map_file.hpp"
#include "tests/support/sample_map.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::maps {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class MapCommand : public ::testing::Test {
 protected:
  MapCommand() { slam::save_map_file(file_, slam::take_snapshot(map_)); }

  /// Exit code of `rtd map ...`; -1 when the command line is refused.
  int run(std::vector<std::string> arguments) {
    CLI::App app;
    MapRequest request;
    add_map_commands(app, request);
    std::reverse(arguments.begin(), arguments.end());
    try {
      app.parse(arguments);
    } catch (const CLI::ParseError&) {
      return -1;
    }
    out_.str({});
    err_.str({});
    return run_map(request, out_, err_);
  }
  std::string path(const std::string& name) const { return folder_.file(name); }
  std::string text_of(const std::string& name) const { return rtd::test::read_text(folder_ / name); }

  const rtd::test::TemporaryFolder folder_;
  const std::string file_ = path("room.rtdmap");
  const slam::Map map_ = test_support::sample_map({.keyframes = 12});
  std::ostringstream out_, err_;
};

TEST_F(MapCommand, info_shows_what_is_in_the_file) {
  ASSERT_EQ(run({"info", file_}), 0) << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("keyframes    11 with 440 features; 2 removed"));
  EXPECT_THAT(out_.str(), HasSubstr(std::to_string(map_.landmark_count()) + " seen"));
  EXPECT_THAT(out_.str(), HasSubstr("640x480, fx 520.00"));
  EXPECT_THAT(out_.str(), HasSubstr("version      2, checksums all right"));
  EXPECT_THAT(out_.str(), HasSubstr("map 0        10 keyframes"));
  EXPECT_THAT(out_.str(), HasSubstr("map 1        1 keyframes, 5 landmarks"));
}

TEST_F(MapCommand, info_prints_json) {
  ASSERT_EQ(run({"info", file_, "--json"}), 0);
  const auto json = nlohmann::json::parse(out_.str());
  EXPECT_EQ(json["keyframes"], 11);
  EXPECT_EQ(json["bytes"], std::filesystem::file_size(file_));
  EXPECT_EQ(json["maps"].size(), 2U);
  EXPECT_EQ(json["cameras"].size(), 1U);
  EXPECT_NEAR(json["maps"][0]["path_m"].get<double>(), 1.1, 0.05);
  EXPECT_NEAR((json["maps"][0]["last_stamp_ns"].get<double>() - json["maps"][0]["first_stamp_ns"].get<double>()) * 1e-9,
              11.0 / 3, 1e-3);
  EXPECT_LT(json["maps"][0]["extent_m"]["min"][2], json["maps"][0]["extent_m"]["max"][2]);
}

TEST_F(MapCommand, exports_landmarks_and_poses_of_one_map) {
  ASSERT_EQ(run({"export", file_, "--format", "ply", "-o", path("a.ply")}), 0) << err_.str();
  EXPECT_THAT(err_.str(), HasSubstr("2 maps"));
  EXPECT_THAT(text_of("a.ply"), HasSubstr("element vertex " + std::to_string(map_.landmark_count() - 5)));
  ASSERT_EQ(run({"export", file_, "--format", "pcd", "-o", path("a.pcd"), "--map-id", "1"}), 0);
  EXPECT_THAT(text_of("a.pcd"), HasSubstr("POINTS 5\nDATA ascii\n0.00000 0.00000 2.00000 "));
  ASSERT_EQ(run({"export", file_, "--format", "tum", "-o", path("a.txt")}), 0);
  const std::string poses = text_of("a.txt");
  EXPECT_EQ(std::count(poses.begin(), poses.end(), '\n'), 10);
  EXPECT_THAT(poses, StartsWith("1700000000.000000 0.000000000 "));
}

TEST_F(MapCommand, exports_a_map_as_a_page) {
  ASSERT_EQ(run({"export", file_, "--format", "html", "-o", path("map.html")}), 0) << err_.str();
  const std::string page = text_of("map.html");
  EXPECT_THAT(page, testing::HasSubstr("Path of the keyframes"));
  EXPECT_THAT(page, testing::EndsWith("</html>\n"));
}

TEST_F(MapCommand, names_what_prevents_an_export) {
  EXPECT_EQ(run({"export", file_, "--format", "ply", "-o", file_}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("exists already"));
  EXPECT_EQ(run({"export", file_, "--format", "ply", "-o", path("none/a.ply")}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("cannot write"));
  EXPECT_EQ(run({"export", file_, "--format", "ply", "-o", path("a.ply"), "--map-id", "7"}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("rtd map info"));
  EXPECT_EQ(run({"export", file_, "--format", "obj", "-o", path("a.obj")}), -1);
}

TEST_F(MapCommand, distinguishes_damage_from_other_files) {
  EXPECT_EQ(run({"info", path("missing.rtdmap")}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("No such file"));
  std::ofstream(folder_ / "text") << "a text";
  EXPECT_EQ(run({"info", path("text")}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("not a map file"));
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 100);
  EXPECT_EQ(run({"info", file_}), 3);
  EXPECT_THAT(err_.str(), HasSubstr("damaged at byte"));
}

TEST_F(MapCommand, exports_landmarks_as_voxels_with_the_free_rays_to_them) {
  ASSERT_EQ(run({"export", file_, "--format", "bt", "-o", path("room.bt")}), 0) << err_.str();
  EXPECT_THAT(err_.str(), HasSubstr("surfaces without landmarks are missing"));
  std::ifstream file(path("room.bt"), std::ios::binary);
  const occupancy::Volume volume = occupancy::read_octomap(file);
  std::size_t free = 0, occupied = 0;
  volume.cells.for_each(
      [&](const Eigen::Vector3i&, occupancy::Space space) { ++(space == occupancy::Space::kFree ? free : occupied); });
  EXPECT_GT(occupied, 10U);
  EXPECT_GT(free, occupied);
}

TEST_F(MapCommand, exports_a_voxel_map_as_floor_plan_with_the_heights_asked_for) {
  occupancy::Volume volume;
  for (int i = 0; i < 400; ++i) {
    volume.cells.set({i % 20, i / 20, 0}, occupancy::Space::kOccupied);  // the floor
    volume.cells.set({i % 20, i / 20, 3}, occupancy::Space::kFree);
  }
  volume.cells.set({5, 5, 16}, occupancy::Space::kOccupied);  // 0.8 m above it
  std::ofstream bt(path("map.bt"), std::ios::binary);
  occupancy::write_octomap(bt, volume);
  bt.close();
  ASSERT_EQ(run({"export", path("map.bt"), "--format", "pgm", "-o", path("tall.pgm")}), 0) << err_.str();
  ASSERT_EQ(run({"export", path("map.bt"), "--format", "pgm", "--max-height", "0.5", "-o", path("low.pgm")}), 0);
  EXPECT_THAT(text_of("tall.yaml"), HasSubstr("image: tall.pgm"));
  const auto blacks = [](const std::string& pgm) { return std::ranges::count(pgm.substr(pgm.size() - 400), '\0'); };
  EXPECT_EQ(blacks(text_of("tall.pgm")), 1);
  EXPECT_EQ(blacks(text_of("low.pgm")), 0);
  EXPECT_EQ(run({"export", path("map.bt"), "--format", "pgm", "-o", path("tall.pgm")}), 2) << "exists";
  EXPECT_EQ(run({"export", path("map.bt"), "--format", "pcd", "-o", path("map.pcd")}), 0);
  EXPECT_THAT(text_of("map.pcd"), HasSubstr("POINTS 401"));
  EXPECT_EQ(run({"export", path("map.bt"), "--format", "tum", "-o", path("map.txt")}), 2);
  EXPECT_EQ(run({"export", path("map.bt"), "--format", "pgm", "-o", path("no_such_folder/x.pgm")}), 1);
}

TEST_F(MapCommand, says_why_there_is_no_floor_plan) {
  EXPECT_EQ(run({"export", file_, "--format", "pgm", "-o", path("room.pgm")}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("rtd run --dense"));
  std::ofstream(path("cut.bt")) << "# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.05\ndata\n";
  EXPECT_EQ(run({"export", path("cut.bt"), "--format", "pgm", "-o", path("cut.pgm")}), 3);
  EXPECT_THAT(err_.str(), HasSubstr("ends in the middle"));
}

}  // namespace
}  // namespace rtd::maps
