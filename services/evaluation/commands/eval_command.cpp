// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/eval_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "common/io/atomic_file.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/json_text.hpp"
#include "services/evaluation/commands/guarded.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::eval {
namespace {

constexpr std::size_t kShownSpans = 5;

std::string row(const std::string& name, const Statistics& s, double factor, const char* unit) {
  if (s.count == 0) return fmt::format("{:<22} no pairs\n", name);
  return fmt::format("{:<22} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:<4} {:>6}\n", name,
                     s.rmse * factor, s.mean * factor, s.median * factor, s.std_dev * factor, s.min * factor,
                     s.max * factor, unit, s.count);
}

std::string rpe_rows(const std::string& name, const RpeResult& rpe) {
  return row(name, rpe.translation_m, 1, "m") + row("", rpe.rotation_rad, kRadToDeg, "deg");
}

std::string coverage_rows(const Coverage& coverage, std::int64_t start_ns) {
  std::string text =
      coverage.frames > 0
          ? fmt::format("coverage               {:.2f} % ({} of {} frames)\n", 100 * coverage.fraction,
                        coverage.tracked, coverage.frames)
          : fmt::format(
                "time with poses        {:.2f} % of the ground truth's (--frames LIST: coverage of the frames)\n",
                100 * coverage.fraction);
  for (std::size_t i = 0; i < std::min(coverage.lost.size(), kShownSpans); ++i) {
    const LostSpan& span = coverage.lost[i];
    text += fmt::format("  without poses        {:.2f} s to {:.2f} s after the start",
                        seconds(span.first_ns - start_ns), seconds(span.last_ns - start_ns));
    text += span.frames > 0 ? fmt::format(" ({} frames)\n", span.frames) : "\n";
  }
  if (coverage.lost.size() > kShownSpans) {
    text += fmt::format("  and {} more (--json lists all)\n", coverage.lost.size() - kShownSpans);
  }
  return text;
}

std::string alignment_rows(const Alignment& alignment) {
  std::string text;
  if (alignment.scale != 1) text += fmt::format("scale                  {:.6f}\n", alignment.scale);
  if (!alignment.unique) {
    text += "note                   poses lie on one line or point: the alignment is one of many, ATE is optimistic\n";
  }
  return text;
}

std::string figure_rows(const std::vector<NamedFigure>& figures) {
  std::string text;
  for (const auto& [name, value] : figures) text += fmt::format("{:<22} {}\n", name, value);
  return text;
}

struct Inputs {
  std::string name;  ///< of the estimate, as it was given
  Trajectory estimate, groundtruth;
  std::vector<PublishedPose> published;  ///< of the estimate, where states are known
  std::optional<std::vector<std::int64_t>> frames_ns;
  std::size_t frames_given = 0;    ///< frames of the source, of which frames_ns may be a part
  std::vector<std::string> notes;  ///< nothing was lost
  std::vector<std::string> damages;
};

void require_stamps_where_given(const EvalOptions& options, const PoseFile& estimate, const PoseFile& groundtruth) {
  const bool given = options.stamps.rate_hz > 0 || !options.stamps.times_file.empty();
  if (given && !estimate.took_stamps && !groundtruth.took_stamps)
    throw service::ConfigError("--rate and --times are for KITTI's format, but both files have stamps; leave them out");
}

/// Poses without stamps belong to those of the same number in the other file, whose stamps they take.
void pair_by_number(const EvalOptions& options, PoseFile& estimate, PoseFile& groundtruth, Inputs& inputs) {
  if (!estimate.numbered && !groundtruth.numbered) return;
  const std::size_t poses = estimate.poses.size();
  if (poses != groundtruth.poses.size()) {
    throw TrajectoryError(fmt::format(
        "{}: 12 numbers a line have no stamps, and {} poses cannot be those of the {} in the other file; give --times "
        "FILE (a stamp in seconds a line, as times.txt of the sequence) or --rate HZ",
        estimate.numbered ? inputs.name : options.groundtruth, poses, groundtruth.poses.size()));
  }
  Trajectory& without = estimate.numbered ? estimate.poses : groundtruth.poses;
  const Trajectory& with = estimate.numbered ? groundtruth.poses : estimate.poses;
  for (std::size_t i = 0; i < poses; ++i) without[i].stamp_ns = with[i].stamp_ns;
  inputs.notes.push_back(estimate.numbered && groundtruth.numbered
                             ? fmt::format("no stamps: pose i belongs to pose i, at {:g} Hz (--rate HZ)", kNumberedHz)
                             : "one file has no stamps: pose i belongs to pose i of the other");
}

/// The frames of the run that wrote the estimate: its folder has run.json.
void take_frames_of_run(const std::filesystem::path& folder, Inputs& inputs) {
  const std::filesystem::path file = folder / "run.json";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return;
  try {
    const run_record::RunRecord record = run_record::read_run_json(file);
    std::vector<std::int64_t> stamps_ns;
    for (const run_record::FrameRecord& frame : record.frames) stamps_ns.push_back(frame.tracking.stamp_ns);
    if (!std::ranges::is_sorted(stamps_ns)) return;
    inputs.frames_ns = std::move(stamps_ns);
    inputs.frames_given = run_record::frame_use(record).given;
  } catch (const run_record::RunFileError&) {
    // of another version, or not of a run: coverage is by time then
  }
}

/// Coverage counts all frames of the source.
void count_given(const Inputs& inputs, Coverage& coverage) {
  if (!inputs.frames_ns || inputs.frames_given <= coverage.frames) return;
  coverage.frames = inputs.frames_given;
  coverage.fraction = static_cast<double>(coverage.tracked) / static_cast<double>(coverage.frames);
}

Inputs read_inputs(const std::string& name, const EvalOptions& options) {
  PoseFile estimate = read_pose_file(name, options.stamps);
  PoseFile groundtruth = read_pose_file(options.groundtruth, options.stamps);
  require_stamps_where_given(options, estimate, groundtruth);
  Inputs inputs{.name = name};
  pair_by_number(options, estimate, groundtruth, inputs);
  inputs.estimate = std::move(estimate.poses);
  inputs.groundtruth = std::move(groundtruth.poses);
  inputs.published = std::move(estimate.published);
  for (PoseFile* file : {&estimate, &groundtruth}) {
    std::ranges::move(file->notes, std::back_inserter(inputs.notes));
    std::ranges::move(file->damages, std::back_inserter(inputs.damages));
  }
  for (PublishedPose& pose : inputs.published) pose.stamp_ns += std::llround(options.offset_s * 1e9);
  if (!options.frames.empty()) {
    inputs.frames_ns = read_frame_stamps(options.frames);
  } else {
    take_frames_of_run(std::filesystem::path(name).parent_path(), inputs);
  }
  return inputs;
}

EvaluationOptions evaluation_options(const EvalOptions& options) {
  EvaluationOptions result;
  result.association = {options.max_difference_s, options.offset_s};
  result.alignment = options.scale ? AlignmentKind::kSimilarity : AlignmentKind::kRigid;
  return result;
}

/// An estimate and what became of it.
struct Judged {
  Inputs inputs;
  Evaluation evaluation;

  bool associates() const { return !evaluation.ate.points.empty(); }
};

std::string drawing(const std::vector<Judged>& all, const EvalOptions& options) {
  Trajectory groundtruth = all.front().inputs.groundtruth;  // on the estimates' clock, which is the plot's
  const std::int64_t offset_ns = std::llround(options.offset_s * 1e9);
  for (StampedPose& pose : groundtruth) pose.stamp_ns -= offset_ns;
  std::vector<NamedAte> named;
  for (const Judged& judged : all) named.push_back({judged.inputs.name, &judged.evaluation.ate});
  return evaluation_svg(named, groundtruth);
}

void write_plot(const std::vector<Judged>& all, const EvalOptions& options) {
  const std::filesystem::path path = options.plot;
  if (path.extension() != ".svg") {
    throw service::ConfigError("--plot " + options.plot + ": only SVG is written; give the file the ending .svg");
  }
  try {
    io::write_file(path, drawing(all, options), {.named_by = io::NamedBy::kOperator});
  } catch (const io::IoError& error) {
    throw service::ConfigError(std::string("--plot ") + error.what());
  }
}

/// What an alignment leaves of two poses is no error.
void leave_out_ate_of_two(Evaluation& evaluation, std::ostream& err) {
  const std::size_t poses = evaluation.ate.error_m.count;
  if (poses == 0 || poses >= kFewestAtePoses) return;
  evaluation.ate.error_m = {};
  err << fmt::format("rtd eval: note: only {} poses have a true one, and any {} fit each other: no ATE\n", poses,
                     kFewestAtePoses - 1);
}

std::string evaluation_table(const Judged& judged, const EvalOptions& options) {
  const Evaluation& e = judged.evaluation;
  const std::int64_t start_ns = e.ate.points.empty() ? 0 : e.ate.points.front().stamp_ns;
  return fmt::format("estimate               {} ({} poses)\nground truth           {} ({} poses)\n", judged.inputs.name,
                     e.estimate_poses, options.groundtruth, e.groundtruth_poses) +
         coverage_rows(e.coverage, start_ns) + alignment_rows(e.ate.alignment) +
         fmt::format("\n{:<22} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:<4} {:>6}\n", "", "rmse", "mean", "median", "std",
                     "min", "max", "", "pairs") +
         row(options.scale ? "ATE (Sim(3))" : "ATE (SE(3))", e.ate.error_m, 1, "m") +
         rpe_rows("RPE per second", e.rpe_per_second) + rpe_rows("RPE per frame", e.rpe_per_frame) +
         rpe_rows("RPE per metre", e.rpe_per_metre) +
         (e.ate.error_m.count == 0 ? "" : "\n" + figure_rows(drift_figures(e.drift, options.scene_depth_m)));
}

/// Where the states of the poses are known.
std::optional<Integrity> integrity_of(const Inputs& inputs, const std::optional<BodyOffset>& offset) {
  if (inputs.published.empty()) return std::nullopt;
  return judge_integrity(inputs.published, camera_truth(inputs.groundtruth, offset));
}

nlohmann::ordered_json json_of(const Judged& judged) {
  nlohmann::ordered_json json = to_json(judged.evaluation);
  const std::optional<Integrity> integrity = integrity_of(judged.inputs, judged.evaluation.offset);
  json["integrity"] = integrity ? to_json(*integrity) : nlohmann::ordered_json(nullptr);
  return json;
}

std::string text_of_one(const Judged& judged, const EvalOptions& options) {
  if (options.json) return service::json_text(json_of(judged)) + "\n";
  const std::optional<Integrity> integrity = integrity_of(judged.inputs, judged.evaluation.offset);
  return evaluation_table(judged, options) + (integrity ? figure_rows(integrity_figures(*integrity)) : "");
}

/// Of a column of the comparison; a run of less than a second has no error per second.
std::string cell(double value) {
  return std::isfinite(value) ? fmt::format(" {:>9.4f}", value) : fmt::format(" {:>9}", "-");
}

/// One row per estimate, in the order given.
std::string comparison_table(const std::vector<Judged>& all, const EvalOptions& options) {
  std::size_t width = 8;
  for (const Judged& judged : all) width = std::max(width, judged.inputs.name.size());
  std::string text = fmt::format("ground truth {} ({} poses)\n\n{:<{}} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n",
                                 options.groundtruth, all.front().evaluation.groundtruth_poses, "estimate", width,
                                 "poses", "coverage", "ATE rmse", "median", "max [m]", "RPE [m/s]", "[deg/s]");
  for (const auto& [inputs, e] : all) {
    const Statistics& ate = e.ate.error_m;
    text += fmt::format("{:<{}} {:>6} {:>7.2f} %", inputs.name, width, e.estimate_poses, 100 * e.coverage.fraction);
    text += ate.count == 0
                ? std::string("   no ATE\n")
                : cell(ate.rmse) + cell(ate.median) + cell(ate.max) + cell(e.rpe_per_second.translation_m.rmse) +
                      cell(e.rpe_per_second.rotation_rad.rmse * kRadToDeg) + "\n";
  }
  return text;
}

std::string text_of(const std::vector<Judged>& all, const EvalOptions& options) {
  if (all.size() == 1) return text_of_one(all.front(), options);
  if (!options.json) return comparison_table(all, options);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Judged& judged : all) {
    list.push_back({{"estimate", judged.inputs.name}});
    list.back().update(json_of(judged));
  }
  return service::json_text(nlohmann::ordered_json{{"groundtruth", options.groundtruth}, {"estimates", list}}) + "\n";
}

std::string explain_no_pairs(const Inputs& inputs, const EvalOptions& options) {
  const Trajectory &estimate = inputs.estimate, &groundtruth = inputs.groundtruth;
  const auto span = [](const Trajectory& t) {
    return fmt::format("{:.6f} to {:.6f} s", seconds(t.front().stamp_ns), seconds(t.back().stamp_ns));
  };
  return fmt::format(
      "rtd eval: no poses associate within {} s.\n"
      "  estimate     {}: {}\n"
      "  ground truth {}: {}\n"
      "Are these files of the same sequence? A constant difference of clocks goes into --offset (added to the\n"
      "estimate; the starts differ by {:.6f} s), a coarse ground truth needs a larger --max-difference.\n",
      options.max_difference_s, inputs.name, span(estimate), options.groundtruth, span(groundtruth),
      seconds(groundtruth.front().stamp_ns - estimate.front().stamp_ns));
}

Judged judge(const std::string& estimate, const EvalOptions& options) {
  Judged judged{read_inputs(estimate, options), {}};
  const Inputs& inputs = judged.inputs;
  judged.evaluation = evaluate(inputs.estimate, inputs.groundtruth, evaluation_options(options), inputs.frames_ns);
  count_given(inputs, judged.evaluation.coverage);
  return judged;
}

/// Notes, and what was left out; of several estimates with the name.
void explain(const Judged& judged, const EvalOptions& options, std::ostream& err) {
  const Inputs& inputs = judged.inputs;
  const std::string from = options.estimates.size() > 1 ? "rtd eval: " + inputs.name + ": " : "rtd eval: ";
  if (const auto unit = other_unit(inputs.estimate, inputs.groundtruth, evaluation_options(options)))
    err << from << "note: " << *unit << '\n';
  if (judged.evaluation.offset) err << from << "note: " << explain(*judged.evaluation.offset) << '\n';
  for (const std::string& note : inputs.notes) err << from << "note: " << note << '\n';
  for (const std::string& damage : inputs.damages) err << from << "left out: " << damage << '\n';
}

}  // namespace

CLI::App* add_eval_command(CLI::App& parent, EvalOptions& options) {
  CLI::App* command = parent.add_subcommand(
      "trajectory", "Compare a trajectory with its ground truth (TUM, KITTI, EuRoC, or poses in a recording)");
  command
      ->add_option_function<std::vector<std::string>>(
          "trajectories",
          [&options](std::vector<std::string> files) {
            options.groundtruth = files.back();
            files.pop_back();
            options.estimates = std::move(files);
          },
          "One trajectory or more to judge, then the ground truth: TUM (stamp tx ty tz qx qy qz qw), KITTI, EuRoC csv, "
          "or a recording: FILE[?topic=/x[&child=FRAME]]")
      ->required()
      ->expected(2, CLI::detail::expected_max_vector_size);
  auto* rate = command->add_option("--rate", options.stamps.rate_hz, "Poses per second of a file in KITTI's format");
  rate->check(CLI::PositiveNumber);
  command->add_option("--times", options.stamps.times_file, "Stamps of a file in KITTI's format: seconds, one a line")
      ->excludes(rate);
  command->add_flag("--json", options.json, "Print JSON instead of a table");
  command->add_option("--plot", options.plot, "Write an SVG: the trajectories, their errors by colour and over time");
  command->add_flag("--scale", options.scale, "Also fit a scale (Sim(3), for monocular trajectories)");
  command->add_option("--max-difference", options.max_difference_s, "Largest time between poses of a pair [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--offset", options.offset_s, "Added to the stamps of the estimate [s]")->capture_default_str();
  command->add_option("--scene-depth", options.scene_depth_m, "How far away the background is, to judge the drift [m]")
      ->check(CLI::PositiveNumber);
  command->add_option("--frames", options.frames, "Frame list (rgb.txt, associations.txt): coverage counts its frames");
  return command;
}

int run_eval(const EvalOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("rtd eval", err, [&] {
    std::vector<Judged> all;
    for (const std::string& estimate : options.estimates) all.push_back(judge(estimate, options));
    for (Judged& judged : all) {
      if (!judged.associates()) err << explain_no_pairs(judged.inputs, options);
      leave_out_ate_of_two(judged.evaluation, err);
    }
    const auto some = std::ranges::count_if(all, &Judged::associates);
    if (some == 0) return service::kRunFailed;
    if (!options.plot.empty()) write_plot(all, options);
    out << text_of(all, options);
    for (const Judged& judged : all) explain(judged, options, err);
    if (some < std::ssize(all)) return service::kRunFailed;
    return std::ranges::all_of(all, [](const Judged& judged) { return judged.inputs.damages.empty(); })
               ? service::kOk
               : service::kPartialLoss;
  });
}

}  // namespace rtd::eval
