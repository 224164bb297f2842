// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/maps/scene_export.hpp"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/camera/open/source_factory.hpp"
#include "common/run_record/run_record.hpp"
#include "common/vision/image_codecs.hpp"
#include "services/slam/map_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::maps {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A run of three keyframes on a rendered scene, whose landmarks are the true places of what was seen.
class SceneExport : public ::testing::Test {
 protected:
  SceneExport() {
    fs::create_directories(run_ / "masks");
    run_record::RunRecord record;
    record.source = kSource;
    run_record::write_run_json(record, run_ / "run.json");
    const auto source = camera::make_source(kSource);
    slam::KeyframeId parent = slam::kNoKeyframe;
    for (int i = 0; const auto frame = source->next(); ++i) {
      if (i % 2 == 1) parent = add_keyframe(*frame, source->info(), parent);
    }
    slam::save_map_file(run_ / "map.rtdmap", slam::take_snapshot(map_));
  }

  slam::KeyframeId add_keyframe(const camera::SourceFrame& source, const camera::SourceInfo& info,
                                slam::KeyframeId parent) {
    const auto& camera = info.camera.parameters();
    const auto frame = std::make_shared<slam::Frame>();
    frame->stamp_ns = source.image.stamp_ns;
    frame->camera = {camera.fx, camera.fy, camera.cx, camera.cy};
    frame->width_px = camera.width;
    frame->height_px = camera.height;
    for (int u = 20; u < camera.width; u += 60) {
      msg::Feature feature{};
      feature.u_px = feature.u_raw_px = static_cast<float>(u);
      feature.v_px = feature.v_raw_px = 100;
      const auto depth = source.image.depth.at<std::uint16_t>(100, u);
      feature.depth_m = static_cast<float>(depth * info.depth_scale_m);
      feature.static_probability = 1;
      feature.object_id = -1;
      if (depth > 0) frame->features.push_back(feature);
    }
    frame->grid = vision::FeatureGrid(frame->features, camera.width, camera.height);
    const Eigen::Isometry3d& T_world_camera = *source.T_world_camera;
    const slam::KeyframeId id = map_.add_keyframe(frame, T_world_camera, parent);
    for (std::uint32_t i = 0; i < frame->features.size(); ++i)
      map_.add_landmark(T_world_camera * frame->unproject(i), {id, i});
    poses_.push_back({frame->stamp_ns, T_world_camera});
    cv::Mat cells(camera.height / 4, camera.width / 4, CV_8U, cv::Scalar(0));
    cells.colRange(0, 10).setTo(255);
    cells.colRange(10, 20).setTo(128);
    vision::write_image(run_ / "masks" / name_of(poses_.back()), cells);
    return id;
  }

  static std::string name_of(const geometry::StampedPose& pose) { return geometry::tum_stamp(pose.stamp_ns) + ".png"; }

  /// Exit code of `rtd export RUN ...`.
  int run(std::vector<std::string> arguments) {
    CLI::App app;
    SceneRequest request;
    add_scene_command(app, request);
    arguments.insert(arguments.begin(), {"scene", run_.string()});
    std::reverse(arguments.begin(), arguments.end());
    app.parse(arguments);
    out_.str({});
    err_.str({});
    return export_scene(request, out_, err_);
  }
  std::string path(const std::string& name) const { return folder_.file(name); }

  static constexpr const char* kSource = "synthetic:office?frames=6&people=0&boxes=0&width=320&height=240";
  const rtd::test::TemporaryFolder folder_;
  const fs::path run_ = folder_ / "run";
  slam::Map map_;
  std::vector<geometry::StampedPose> poses_;
  std::ostringstream out_, err_;
};

TEST_F(SceneExport, colmap_has_the_poses_of_keyframes_and_points_where_they_were_seen) {
  ASSERT_EQ(run({"--colmap", path("colmap")}), 0) << err_.str();
  const fs::path model = path("colmap/sparse/0");
  std::map<std::string, Eigen::Vector3d> points;
  std::ifstream points_file(model / "points3D.txt"), images(model / "images.txt"), cameras(model / "cameras.txt");
  for (std::string line; std::getline(points_file, line);) {
    std::istringstream row(line);
    std::string id;
    Eigen::Vector3d p;
    row >> id >> p.x() >> p.y() >> p.z();
    points[id] = p;
  }
  std::string number, kind;
  double width, height, fx, fy, cx, cy;
  ASSERT_TRUE(cameras >> number >> kind >> width >> height >> fx >> fy >> cx >> cy);
  EXPECT_EQ(kind, "PINHOLE");
  std::size_t seen = 0;
  for (const geometry::StampedPose& pose : poses_) {
    std::string id, camera, name, line;
    Eigen::Quaterniond q;
    Eigen::Vector3d t;
    ASSERT_TRUE(images >> id >> q.w() >> q.x() >> q.y() >> q.z() >> t.x() >> t.y() >> t.z() >> camera >> name);
    const Eigen::Isometry3d T_camera_world = Eigen::Translation3d(t) * q;
    EXPECT_TRUE(T_camera_world.inverse().isApprox(pose.T_world_body, 1e-6)) << name;
    EXPECT_EQ(name, name_of(pose));
    std::getline(images >> std::ws, line);
    std::istringstream row(line);
    for (double u, v; row >> u >> v >> id; ++seen) {
      const Eigen::Vector3d p = T_camera_world * points.at(id);
      EXPECT_NEAR(fx * p.x() / p.z() + cx, u, 0.01);
      EXPECT_NEAR(fy * p.y() / p.z() + cy, v, 0.01);
    }
  }
  EXPECT_EQ(seen, points.size());
  EXPECT_GT(seen, 6U);
}

TEST_F(SceneExport, nerfstudio_has_the_same_poses_in_axes_of_opengl) {
  ASSERT_EQ(run({"--nerfstudio", path("ns")}), 0) << err_.str();
  const auto json = nlohmann::json::parse(std::ifstream(path("ns/transforms.json")));
  ASSERT_EQ(json["frames"].size(), poses_.size());
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const auto& frame = json["frames"][i];
    Eigen::Matrix4d T;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) T(row, column) = frame["transform_matrix"][row][column];
    const Eigen::Matrix4d wanted = poses_[i].T_world_body.matrix() * Eigen::Vector4d(1, -1, -1, 1).asDiagonal();
    EXPECT_TRUE(T.isApprox(wanted, 1e-9));
    for (const char* file : {"file_path", "mask_path"})
      EXPECT_TRUE(fs::exists(fs::path(path("ns")) / frame[file].get<std::string>()));
  }
  EXPECT_EQ(json["w"], 320);
  EXPECT_TRUE(fs::exists(path("ns/points.ply")));
}

TEST_F(SceneExport, masks_are_black_where_something_moves) {
  ASSERT_EQ(run({"--colmap", path("colmap")}), 0);
  const auto mask =
      vision::read_image(path("colmap/masks/" + name_of(poses_[1]) + ".png"), {.pixels = vision::PixelsAs::kStored});
  ASSERT_EQ(mask.pixels.size(), cv::Size(320, 240)) << mask.problem;
  EXPECT_EQ(mask.pixels.at<std::uint8_t>(100, 39), 0);
  EXPECT_EQ(mask.pixels.at<std::uint8_t>(100, 41), 255) << "unknown is used";
  EXPECT_EQ(mask.pixels.at<std::uint8_t>(100, 200), 255);
}

TEST_F(SceneExport, what_is_missing_is_said_and_ends_with_exit_3) {
  fs::remove(run_ / "masks" / name_of(poses_[1]));
  EXPECT_EQ(run({"--colmap", path("two")}), 3);
  EXPECT_THAT(err_.str(), HasSubstr("1 of 3 keyframes left out"));
  fs::remove_all(run_ / "masks");
  EXPECT_EQ(run({"--nerfstudio", path("bare")}), 3);
  EXPECT_THAT(err_.str(), AllOf(HasSubstr("no masks"), HasSubstr("rtd run --dense")));
  EXPECT_FALSE(nlohmann::json::parse(std::ifstream(path("bare/transforms.json")))["frames"][0].contains("mask_path"));
}

TEST_F(SceneExport, what_cannot_be_exported_is_refused_with_the_fix) {
  EXPECT_EQ(run({}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("--colmap OUT"));
  EXPECT_EQ(run({"--colmap", run_.string()}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("exists already"));
  EXPECT_EQ(run({"--colmap", path("out"), "--source", "tum:/nowhere"}), 2);
  EXPECT_THAT(err_.str(), AllOf(HasSubstr("tum:/nowhere"), HasSubstr("--source names"), HasSubstr("--record")));
  EXPECT_EQ(run({"--colmap", path("out"), "--source", "synthetic:office?fps=7&frames=3"}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("none of the 3 keyframes"));
  fs::remove(run_ / "map.rtdmap");
  EXPECT_EQ(run({"--colmap", path("out")}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("--localize-only"));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(SceneExport, colmap_itself_reads_the_model) {
  if (std::system("command -v colmap > /dev/null") != 0) GTEST_SKIP() << "colmap is not installed";
  ASSERT_EQ(run({"--colmap", path("colmap")}), 0);
  EXPECT_EQ(std::system(("colmap model_analyzer --path " + path("colmap/sparse/0")).c_str()), 0);
}

}  // namespace
}  // namespace rtd::maps
