// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd_place_recall SOURCE...: does the vocabulary know places again? Every second chosen frame of all sources goes into
// one database, the others ask. An answer is right when it is of the same source, near and looks the same way.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <numbers>
#include <optional>

#include "common/camera/open/source_factory.hpp"
#include "common/geometry/se3.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"
#include "services/filter/core/orb/orb_extractor.hpp"
#include "services/slam/core/place/keyframe_database.hpp"
#include "services/slam/core/place/vocabulary.hpp"

namespace {

using namespace rtd;

struct View {
  std::size_t source = 0;
  Eigen::Isometry3d T_world_camera;
  slam::BagOfWords bag;
};

struct Rules {
  std::size_t every = 5, frames = 0;
  double near_m = 0.5, near_deg = 30;
};

std::optional<Eigen::Isometry3d> pose_at(const geometry::Trajectory& truth, std::int64_t stamp_ns) {
  const geometry::StampedPose* best = nullptr;
  for (const geometry::StampedPose& pose : truth) {
    if (best == nullptr || std::abs(pose.stamp_ns - stamp_ns) < std::abs(best->stamp_ns - stamp_ns)) best = &pose;
  }
  if (best == nullptr || std::abs(best->stamp_ns - stamp_ns) > 50'000'000) return std::nullopt;
  return best->T_world_body;
}

void add_views(const std::string& uri, std::size_t source_index, const Rules& rules, std::vector<View>& views) {
  const auto source = camera::make_source(uri);
  filter::OrbExtractor extractor{filter::OrbConfig{}};
  for (std::size_t i = 0; rules.frames == 0 || i < rules.frames; ++i) {
    const auto frame = source->next();
    if (!frame) break;
    if (i % rules.every != 0) continue;
    const auto T_world_camera =
        frame->T_world_camera ? frame->T_world_camera : pose_at(source->groundtruth(), frame->image.stamp_ns);
    if (!T_world_camera) continue;
    views.push_back(
        {source_index, *T_world_camera, slam::built_in_vocabulary()->describe(extractor.extract(frame->image))});
  }
}

bool same_place(const View& a, const View& b, const Rules& rules) {
  if (a.source != b.source) return false;
  const Eigen::Isometry3d T_a_b = a.T_world_camera.inverse() * b.T_world_camera;
  return T_a_b.translation().norm() < rules.near_m &&
         geometry::rotation_angle_rad(T_a_b) < rules.near_deg * std::numbers::pi / 180;
}

struct Score {
  int asked = 0, first = 0, of_three = 0, of_ten = 0;
  double right = 0, wrong = 0;  ///< similarity of the best right and the best wrong answer, summed
};

void ask(const slam::KeyframeDatabase& database, const std::vector<View>& views, std::size_t index, const Rules& rules,
         Score& score) {
  const auto hits = database.query(views[index].bag);
  const auto right = [&](const slam::ScoredKeyframe& hit) {
    return same_place(views[hit.keyframe], views[index], rules);
  };
  bool known = false;
  for (std::size_t i = 0; i < views.size(); i += 2) known = known || same_place(views[i], views[index], rules);
  if (!known) return;
  ++score.asked;
  const auto best_right = std::find_if(hits.begin(), hits.end(), right);
  const auto best_wrong = std::find_if_not(hits.begin(), hits.end(), right);
  const auto rank = best_right - hits.begin();
  if (best_right != hits.end()) score.right += static_cast<double>(best_right->score);
  if (best_wrong != hits.end()) score.wrong += static_cast<double>(best_wrong->score);
  score.first += rank < 1 ? 1 : 0;
  score.of_three += rank < 3 ? 1 : 0;
  score.of_ten += rank < 10 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> sources;
  Rules rules;
  CLI::App app{"Recall of place recognition over several sources"};
  app.add_option("sources", sources, "URIs as rtd-camera takes them, e.g. tum:FOLDER")->required();
  app.add_option("--every", rules.every, "take each n-th frame")->check(CLI::Range(1, 10000));
  app.add_option("--frames", rules.frames, "of each source; 0: all");
  app.add_option("--near-m", rules.near_m, "distance of two views of one place");
  app.add_option("--near-deg", rules.near_deg, "their angle");
  CLI11_PARSE(app, argc, argv);
  std::vector<View> views;
  for (std::size_t i = 0; i < sources.size(); ++i) add_views(sources[i], i, rules, views);
  slam::KeyframeDatabase database;
  for (std::size_t i = 0; i < views.size(); i += 2) database.add(static_cast<slam::KeyframeId>(i), views[i].bag);
  std::printf("%zu views, %zu known\n%-50s asked  first  of3  of10  similarity right / wrong\n", views.size(),
              database.size(), "source");
  for (std::size_t source = 0; source < sources.size(); ++source) {
    Score score;
    for (std::size_t i = 1; i < views.size(); i += 2) {
      if (views[i].source == source) ask(database, views, i, rules, score);
    }
    const double n = std::max(1, score.asked);
    std::printf("%-50s %5d  %.3f %.3f %.3f  %.3f / %.3f\n", sources[source].c_str(), score.asked, score.first / n,
                score.of_three / n, score.of_ten / n, score.right / n, score.wrong / n);
  }
  return 0;
}
