// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <istream>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/map_page/map_page.hpp"
#include "services/evaluation/core/report/run_summary.hpp"

namespace rtd::eval {

/// The points of static_map.ply as dense writes it; none of any other file.
map_page::Layer read_static_map(std::istream& in);

/// The points of a PLY text file as slam writes its landmarks (map.ply): x y z first, metres, at most `most`, evenly
/// spread. Empty for any other file.
std::vector<Eigen::Vector3d> read_landmarks(std::istream& in, std::size_t most);

/// What a run left, to look at in a browser: the dense map or, without one, static points in
/// colour, landmarks, path and ground truth.
map_page::Page map_page_of(const Run& run, const RunSummary& summary);

/// Reads run.json and finds the other files of the run in `folder`. Throws RunFileError.
Run load_run(const std::string& folder);

/// Leaves the pages of the run in `folder` that exist, with their places as seen from `page`.
void link_from(const std::filesystem::path& page, const std::filesystem::path& folder, Run& run);

/// Compares the removed points with the true masks of the source and sets Run::removal. An interrupted run is judged on
/// a few frames only: the user waits. `go_on` is asked before each frame. Masks that cannot be used become an event.
void judge_run(Run& run, const std::function<bool()>& go_on);

/// When slam left no trajectory.txt, the run is judged by the poses as they were published; that becomes an event.
void choose_trajectory(Run& run, const std::string& folder);

/// The content of report.json (keys: docs/evaluation.md). Every key is always there; what is unknown is null when
/// printed.
nlohmann::ordered_json report_json(const Run& run, const RunSummary& summary);

/// The report page of one run: page.html with everything inside, no references to the outside.
std::string report_html(const Run& run, const RunSummary& summary);

/// The table that ends a run on the terminal.
std::string summary_text(const Run& run, const RunSummary& summary, const std::string& folder);

/// Writes DIR/report.json, DIR/report.html and DIR/map.html and returns the numbers. Throws std::runtime_error naming
/// the file when one cannot be written; bad or missing trajectories become notes in both files.
RunSummary write_report(const Run& run, const std::filesystem::path& folder);

/// One run of a comparison.
struct ComparedRun {
  std::string label;  ///< e.g. "filter off"
  Run run;
};

/// A self-contained page that shows runs of the same source next to each other: trajectories in one plot against the
/// ground truth, errors over time, numbers, sample frames. The first run is the baseline.
std::string comparison_html(const std::vector<ComparedRun>& runs);

/// ATE and coverage of the runs, a line each, for the terminal.
std::string comparison_text(const std::vector<ComparedRun>& runs);

}  // namespace rtd::eval
