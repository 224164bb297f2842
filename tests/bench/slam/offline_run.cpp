// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <tuple>

#include "common/msg/filter_modes.hpp"
#include "common/msg/word_list.hpp"
#include "common/service/config.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"
#include "services/slam/config.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace {

/// CPU time of this thread: what slam costs, whatever else the machine does.
std::int64_t cpu_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
}

void print(const rtd::test_support::OfflineReport& report) {
  std::printf("frames %zu  coverage %.3f  ATE %.4f m, as published %.4f m, NEES %.1f  RPE %.4f m %.3f deg\n",
              report.frames, report.coverage, report.ate_rmse_m, report.online_ate_rmse_m, report.nees,
              report.rpe_trans_rmse_m, report.rpe_rot_rmse_deg);
  std::printf("keyframes %zu  landmarks %zu\n", report.keyframes, report.landmarks);
  if (report.predicted_frames > 0) {
    std::printf("predicted by IMU or wheels: %zu frames, NEES %.1f\n", report.predicted_frames, report.predicted_nees);
  }
  for (const auto& figures :
       {rtd::eval::drift_figures(report.drift, std::nullopt), rtd::eval::integrity_figures(report.integrity)})
    for (const auto& [name, value] : figures) std::printf("%-22s %s\n", name.c_str(), value.c_str());
  if (report.removal.removed_rightly + report.removal.kept_wrongly > 0) {
    std::printf("removed features after 1 s: precision %.3f  recall %.3f\n", report.removal.precision(),
                report.removal.recall());
  }
  for (const auto& [closure, error_m, error_rad] : report.loops) {
    std::printf("loop %u - %u: %d inliers, moved %.3f m, joined %d, off by %.3f m %.4f rad%s\n", closure.edge.older,
                closure.edge.newer, closure.edge.inliers, closure.correction_m, closure.joined, error_m, error_rad,
                closure.merged ? ", maps merged" : "");
  }
  for (const auto& [name, values] : report.stage_ms) {
    double sum = 0;
    for (const double value : values) sum += value;
    std::printf("  %-16s mean %7.2f  p50 %7.2f  p99 %7.2f  max %7.2f ms\n", name.c_str(),
                sum / static_cast<double>(values.size()), percentile(values, 0.5), percentile(values, 0.99),
                percentile(values, 1));
  }
}

/// One line for programs; null where nothing could be measured.
void print_json(const rtd::test_support::OfflineReport& report) {
  double lost_m = 0;  // worst position error
  for (const auto& point : rtd::eval::ate(report.trajectory, report.groundtruth).points) {
    lost_m = std::max(lost_m, point.error_m);
  }
  const rtd::eval::RemovalQuality& removal = report.removal;
  const bool masks = removal.removed_rightly + removal.kept_wrongly > 0;
  const bool removes = removal.removed_rightly + removal.removed_wrongly > 0;
  const auto ms = [&](const char* stage) {
    const auto found = report.stage_ms.find(stage);
    return found == report.stage_ms.end() ? nlohmann::json() : nlohmann::json(percentile(found->second, 0.5));
  };
  double loop_error_m = 0;  // of the worst one
  for (const auto& loop : report.loops) loop_error_m = std::max(loop_error_m, loop.error_m);
  nlohmann::ordered_json integrity = rtd::eval::to_json(report.integrity);
  integrity["drift"] = rtd::eval::to_json(report.drift);
  const nlohmann::json line = {{"frames", report.frames},
                               {"integrity", integrity},
                               {"loops", report.loops.size()},
                               {"loop_error_m", loop_error_m},
                               {"coverage", report.coverage},
                               {"ate_m", report.ate_rmse_m},
                               {"online_ate_m", report.online_ate_rmse_m},
                               {"nees", report.nees},
                               {"doubtful", static_cast<double>(report.doubtful_frames) /
                                                std::max<double>(1, static_cast<double>(report.frames))},
                               {"states", integrity["states"]},
                               {"max_error_m", lost_m},
                               {"predicted", report.predicted_frames},
                               {"predicted_nees", report.predicted_nees},
                               {"rpe_m", report.rpe_trans_rmse_m},
                               {"rpe_deg", report.rpe_rot_rmse_deg},
                               {"keyframes", report.keyframes},
                               {"landmarks", report.landmarks},
                               {"disparity_px_m", report.disparity_px_m},
                               {"readout_s", report.readout_s},
                               {"precision", masks && removes ? nlohmann::json(removal.precision()) : nlohmann::json()},
                               {"recall", masks ? nlohmann::json(removal.recall()) : nlohmann::json()},
                               {"filter_ms", ms("filter.total")},
                               {"slam_ms", ms("slam.total")}};
  std::printf("%s\n", line.dump().c_str());  // NaN is written as null
}

/// "2:3" -> from second 2 to second 3.
rtd::test_support::Outage parse_outage(const std::string& text) {
  rtd::test_support::Outage outage;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf:%lf%c", &outage.begin_s, &outage.end_s, &rest) == 2) return outage;
  throw CLI::ValidationError("--detector-outage", "'" + text + "' is not BEGIN:END in seconds");
}

void add_detector_options(CLI::App& app, rtd::test_support::DetectorOptions& detector) {
  app.add_option("--detector", detector.kind, "real, truth (synthetic sources), lying, off")
      ->check(CLI::IsMember({"real", "truth", "lying", "off"}));
  app.add_option("--detector-hz", detector.rate_hz, "at most so many images a second, 0 = every frame");
  app.add_option("--detector-delay-ms", detector.delay_ms, "its boxes come so late");
  app.add_option("--detector-seed", detector.seed, "of truth, lying and jitter");
  app.add_option("--detector-jitter", detector.jitter_real_share,
                 "real: standard deviation by which the edges of its boxes are moved, share of their size")
      ->check(CLI::Range(0.0, 0.5));
  app.add_option("--detector-missed", detector.missed_share, "truth: share of the boxes not found");
  app.add_option("--detector-recall", detector.recall,
                 "truth: share of the boxes found; misses come in bursts of 0.3 to 2 s")
      ->check(CLI::Range(rtd::test_support::kLeastRecall, 1.0));
  app.add_option("--detector-cut", detector.cut_share, "truth: share of the boxes that lack a part at one side")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--detector-model", detector.model, "real: its network")->capture_default_str();
  app.add_option("--detector-confidence", detector.confidence, "real: least score");
  app.add_option(
      "--masks", detector.masks,
      "off; truth: moving pixels of the source in the boxes of people; or the ONNX file of a network for them");
  app.add_option("--remembered-masks", detector.masks_remembered_in,
                 "of a network: file that remembers its answers for this source and its detections");
  app.add_option(
      "--detections", detector.remembered_in,
      "real and truth: file that remembers the answers for this source, so that the next run need not ask again");
  app.add_option_function<std::vector<std::string>>(
      "--detector-outage",
      [&detector](const std::vector<std::string>& spans) {
        for (const std::string& span : spans) detector.outages.push_back(parse_outage(span));
      },
      "gone from BEGIN:END, seconds after the first frame");
}

using rtd::test_support::ImageFault;

/// "0.5:2:3" -> 0.5 from second 2 to second 3; of darkness "2:3".
ImageFault parse_fault(ImageFault::Kind kind, const std::string& text) {
  ImageFault fault{kind};
  const bool dark = kind == ImageFault::Kind::kDark;
  const std::string whole = dark ? "0:" + text : text;
  char rest = 0;
  if (std::sscanf(whole.c_str(), "%lf:%lf:%lf%c", &fault.amount, &fault.begin_s, &fault.end_s, &rest) == 3)
    return fault;
  throw CLI::ValidationError("'" + text + "' is not " + (dark ? "BEGIN:END" : "AMOUNT:BEGIN:END") + " in seconds");
}

void add_image_fault_options(CLI::App& app, std::vector<ImageFault>& faults) {
  const auto add = [&](const char* name, ImageFault::Kind kind, const char* help) {
    app.add_option_function<std::vector<std::string>>(
        name,
        [&faults, kind](const std::vector<std::string>& texts) {
          for (const std::string& text : texts) faults.push_back(parse_fault(kind, text));
        },
        help);
  };
  add("--occlude", ImageFault::Kind::kOcclude, "SHARE:BEGIN:END: something textured covers this share of the view");
  add("--person", ImageFault::Kind::kPerson, "the same, and the detector takes it for a person");
  add("--dark", ImageFault::Kind::kDark, "BEGIN:END: the light is off, seconds after the first frame");
  add("--blur", ImageFault::Kind::kBlur, "PX:BEGIN:END: colour is smeared along its rows");
}

void add_imu_options(CLI::App& app, rtd::test_support::OfflineOptions& options) {
  app.add_option_function<std::uint64_t>(
      "--imu-of-truth",
      [&options](std::uint64_t seed) {
        if (!options.imu_of_truth) options.imu_of_truth.emplace();
        options.imu_seed = seed;
      },
      "SEED: an IMU of 200 Hz made of the source's ground truth, with noise and biases of this seed");
  app.add_option_function<double>(
      "--imu-noise",
      [&options](double factor) {
        if (!options.imu_of_truth) options.imu_of_truth.emplace();
        options.imu_of_truth->gyro_noise_rad_s_rthz *= factor;
        options.imu_of_truth->accel_noise_m_s2_rthz *= factor;
      },
      "so many times the noise of a cheap IMU");
  app.add_flag_callback(
      "--imu-filter-only", [&options] { options.imu_for_slam = false; }, "the filter has it, slam does not");
}

void add_slam_options(CLI::App& app, rtd::slam::SlamConfig& slam) {
  app.add_option("--disparity", slam.sensor.disparity_px_m);
  app.add_option("--close-depth", slam.sensor.close_depth_m);
  app.add_option("--max-depth", slam.sensor.max_depth_m);
  app.add_option("--reference-ratio", slam.keyframe.reference_ratio);
  app.add_option("--min-gap", slam.keyframe.min_gap_s);
  app.add_option("--ba-keyframes", slam.mapper.ba_keyframes);
  app.add_option("--ba-fixed", slam.mapper.ba_fixed_keyframes);
  app.add_option("--ba-robust", slam.mapper.ba_iterations_robust);
  app.add_option("--ba-iterations", slam.mapper.ba_iterations);
  app.add_option("--loop-closing", slam.techniques.loop_closing, "true, false");
  app.add_option("--global-iterations", slam.loop.global_iterations);
}

/// The settings of the filter, and the configuration of slam with those of slam.
std::pair<std::vector<std::string>, rtd::slam::SlamConfig> split_settings(const std::vector<std::string>& settings,
                                                                          rtd::slam::ServiceConfig& slam) {
  std::vector<std::string> filter_settings;
  rtd::service::ConfigBinder binder;
  binder.section("slam", slam);
  for (const std::string& setting : settings) {
    setting.starts_with("slam.") ? binder.set(setting) : filter_settings.push_back(setting);
  }
  return {filter_settings, rtd::slam::core_config(slam)};
}

void print_errors(const rtd::test_support::OfflineReport& report) {
  for (const auto& point : rtd::eval::ate(report.trajectory, report.groundtruth).points) {
    std::printf("%.6f %.4f\n", static_cast<double>(point.stamp_ns) * 1e-9, point.error_m);
  }
}

void write_truth(const rtd::test_support::OfflineReport& report, const std::string& path) {
  std::ofstream file(path);
  rtd::geometry::write_tum_trajectory(file, report.groundtruth);
}

}  // namespace

/// Runs the system on a source in one thread and prints its errors and times: the instrument for tuning.
int main(int argc, char** argv) {
  CLI::App app("RTD-SLAM offline: accuracy and stage times of one source");
  rtd::test_support::OfflineOptions options;
  std::string trajectory_file, truth_file;
  bool verbose = false, threaded = false, errors = false, json = false;
  rtd::slam::ServiceConfig slam_settings;
  std::vector<std::string> settings;
  app.add_option("--source", options.source, "source URI or TUM folder")->required();
  app.add_option("--mode", options.front_end.mode, "true-mask, " + rtd::msg::word_list(rtd::msg::filter_mode_names()));
  app.add_option("--set", settings, "filter.KEY=VALUE or slam.KEY=VALUE, e.g. filter.techniques.belief=false");
  add_detector_options(app, options.front_end.detector);
  add_image_fault_options(app, options.front_end.image_faults);
  add_slam_options(app, slam_settings.core);
  add_imu_options(app, options);
  app.add_option("--first-frame", options.first_frame, "pass over so many frames of the source");
  app.add_option("--every", options.frame_step, "use only every n-th frame, as from a slower camera")
      ->check(CLI::Range(1, 1000));
  app.add_option("--frames", options.max_frames, "stop after so many frames, 0 = all");
  app.add_option("--out", trajectory_file, "write the trajectory here, TUM format");
  app.add_option("--truth", truth_file, "write the source's own trajectory here, TUM format");
  app.add_option("--min-period", options.min_period_s, "seconds between two frames at least, as from a live camera");
  app.add_flag("--threaded", threaded, "mapping in a thread of its own");
  app.add_flag_callback(
      "--cpu-time", [&] { options.now_ns = cpu_ns; }, "slam's stage times in CPU time");
  app.add_flag("--errors", errors, "position error of every frame after alignment, metres");
  app.add_flag("--json", json, "one line of JSON instead of the table");
  app.add_flag("--verbose", verbose, "a line per frame");
  CLI11_PARSE(app, argc, argv);
  if (options.source.find(':') == std::string::npos) {
    const std::string has_masks = std::filesystem::exists(options.source + "/mask") ? "?masks=1" : "";
    options.source = "tum:" + options.source + has_masks;
  }
  if (threaded) options.mapping = rtd::slam::MappingMode::kThreaded;
  if (verbose) {
    options.on_frame = [](const rtd::slam::SlamOutput& output) {
      const auto& r = output.result;
      std::printf(
          "%4lu state %u inliers %4u static %4u removed %4u keyframes %3u landmarks %5u events %zu  %.1f ms %s\n",
          static_cast<unsigned long>(r.seq), static_cast<unsigned>(r.state), r.inliers, r.features_static,
          r.features_removed, r.keyframes, r.landmarks, output.changes.size(),
          static_cast<double>(r.stage_ms[rtd::msg::kStageSlamTotal]), output.problem.c_str());
    };
  }
  try {
    std::tie(options.front_end.filter_settings, options.slam) = split_settings(settings, slam_settings);
    const auto report = rtd::test_support::run_offline(options);
    json ? print_json(report) : print(report);
    if (errors) print_errors(report);
    if (!trajectory_file.empty()) std::ofstream(trajectory_file) << report.trajectory_tum;
    if (!truth_file.empty()) write_truth(report, truth_file);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
