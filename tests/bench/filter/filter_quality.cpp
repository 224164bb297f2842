// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "services/filter/core/dynamic_filter.hpp"
#include "tests/support/evaluation_clip.hpp"

using namespace rtd;

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  test_support::EvaluationClip clip(argv[1]);
  filter::FilterConfig config;
  config.mode = filter::FilterMode::kGeometry;
  bool verbose = false; const char* draw = nullptr; bool gt = false;
  for (int i = 2; i < argc; ++i) {
    if (!strcmp(argv[i], "-v")) verbose = true;
    if (!strcmp(argv[i], "-gt")) gt = true;
    if (!strcmp(argv[i], "-draw")) draw = argv[++i];
  }
  filter::DynamicFilter f(config, [] { return std::chrono::steady_clock::now().time_since_epoch().count(); });
  double tp = 0, fp = 0, fn = 0, tn = 0; std::array<double, 8> ms{}; double worst_t = 0;
  std::vector<Eigen::Isometry3d> est;
  for (std::size_t i = 0; i < clip.size(); ++i) {
    auto image = clip.image(i);
    auto r = f.apply(image, std::nullopt);
    if (gt) { msg::TrackingResult t{}; t.seq = i; t.state = msg::TrackingState::kOk;
      Eigen::Isometry3d T = clip.T_world_camera(i); Eigen::Quaterniond q(T.linear());
      t.T_world_camera = {{T.translation().x(), T.translation().y(), T.translation().z()}, {q.x(), q.y(), q.z(), q.w()}}; f.on_tracking(t); }
    est.push_back(r.T_world_camera);
    cv::Mat mask = clip.dynamic_mask(i), wide;
    if (!mask.empty()) cv::dilate(mask, wide, cv::getStructuringElement(cv::MORPH_RECT, {7, 7}));
    int a = 0, b = 0, c = 0, d = 0;
    for (const auto& x : r.features) {
      bool removed = x.flags & msg::kFeatureRemoved;
      int u = std::lround(x.u_raw_px), v = std::lround(x.v_raw_px);
      bool on = !mask.empty() && mask.at<uint8_t>(v, u), near = !mask.empty() && wide.at<uint8_t>(v, u);
      if (removed) (near ? a : b)++; else (on ? c : d)++;
    }
    tp += a; fp += b; fn += c; tn += d;
    for (int k = 0; k < 8; ++k) ms[k] += r.stage_ms[k];
    Eigen::Isometry3d E = clip.T_world_camera(i).inverse() * r.T_world_camera;
    worst_t = std::max(worst_t, E.translation().norm());
    if (verbose) printf("%3zu n %4zu tp %4d fp %4d fn %4d clusters %u rel %d err %.4f m %.2f deg\n", i, r.features.size(), a, b, c, r.dynamic_clusters, r.pose_reliable, E.translation().norm(), Eigen::AngleAxisd(E.linear()).angle() * 57.3);
    if (draw && i % 10 == 0) {
      cv::Mat im = image.color_bgr.clone();
      for (const auto& x : r.features) cv::circle(im, {int(x.u_raw_px), int(x.v_raw_px)}, 3, x.flags & msg::kFeatureRemoved ? cv::Scalar(0, 0, 255) : (x.flags & msg::kFeatureGeometryStatic ? cv::Scalar(0, 255, 0) : cv::Scalar(255, 255, 0)), 1);
      cv::imwrite(std::string(draw) + std::to_string(i) + ".png", im);
    }
  }
  double n = clip.size();
  printf("%s precision %.4f recall %.4f fn/frame %.1f fp/frame %.1f tn/frame %.0f worst own pose error %.4f m\n", argv[1], tp / std::max(1.0, tp + fp), tp / std::max(1.0, tp + fn), fn / n, fp / n, tn/n, worst_t);
  printf("ms: extract %.2f masks %.2f ego %.2f check %.2f fuse %.2f total %.2f\n", ms[1] / n, ms[2] / n, ms[3] / n, ms[4] / n, ms[5] / n, ms[6] / n);
}
