// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd_relocalization SOURCE: cuts a clip many times and resumes it elsewhere on the map, every other time after 3 s of
// a covered camera. One line per cut.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>

#include "tests/support/relocalization_trial.hpp"

namespace {

using namespace rtd;

struct Options {
  std::string source, again;
  std::size_t frames = 300, mapped = 0, cuts = 20;
  double truth_offset_ms = 0;
  bool masks = false, threaded = false;
  std::optional<std::size_t> only;  ///< this cut, with a line per frame
  slam::SlamConfig slam;
};

void print_frame(const slam::FrameResult& result, double error_m, double error_deg) {
  std::printf("   %llu %s: %u inliers of %u features, map %u, %.4f m %.2f deg\n",
              static_cast<unsigned long long>(result.seq), to_string(result.state), result.inliers,
              result.features_static, result.map_id, error_m, error_deg);
}

/// Cut `index` of a clip of `size` frames: the map ends between 1/2 and 3/4 of it; the camera comes back to frames that
/// it has not mapped, or anywhere on the mapped part of another recording of the same path.
test_support::RelocalizationTrial cut(const Options& options, std::size_t size, std::size_t index) {
  const double share = static_cast<double>((7 * index) % options.cuts) / static_cast<double>(options.cuts);
  test_support::RelocalizationTrial trial;
  trial.covered = index % 2 == 0 ? 90 : 0;
  trial.length = 33;
  if (!options.again.empty()) {
    trial.mapped = size;
    trial.resume = static_cast<std::size_t>(share * static_cast<double>(size - 2 * trial.length));
    return trial;
  }
  trial.mapped = size / 2 + index % 5 * size / 20;
  trial.resume =
      trial.mapped + 8 + static_cast<std::size_t>(share * static_cast<double>(size - trial.mapped - trial.length - 8));
  return trial;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Loses the camera and finds it again"};
  app.add_option("source", options.source, "URI as rtd-camera takes it, with ground truth")->required();
  app.add_option("--again", options.again, "the same path recorded again; none: later frames of the source");
  app.add_option("--frames", options.frames, "of the source");
  app.add_option("--cuts", options.cuts, "how often");
  app.add_flag("--masks", options.masks, "drop features on the source's masks of moving pixels");
  app.add_option("--truth-offset-ms", options.truth_offset_ms,
                 "the truth's clock shows so much more than the images' stamps (fr1_xyz: -15)");
  app.add_flag("--threaded", options.threaded, "mapping in a thread of its own, 30 frames a second");
  app.add_option("--candidates-per-frame", options.slam.place.candidates_per_frame);
  app.add_option("--only", options.only, "this cut, with a line per frame");
  app.add_option("--min-inliers", options.slam.place.min_inliers);
  app.add_option("--min-found-ratio", options.slam.place.min_found_ratio);
  app.add_option("--confirmations", options.slam.place.confirmations);
  CLI11_PARSE(app, argc, argv);
  const auto record = [&](const std::string& source) {
    return test_support::record_features(source, 0, options.frames, options.masks, 1e-3 * options.truth_offset_ms);
  };
  const auto mapped = record(options.source);
  const auto again = options.again.empty() ? mapped : record(options.again);
  const test_support::WorldAlignment alignment = align_worlds(mapped, options.slam);
  std::size_t good = 0;
  for (std::size_t i = 0; i < options.cuts; ++i) {
    if (options.only && *options.only != i) continue;
    auto trial = cut(options, std::min(mapped.frames.size(), again.frames.size()), i);
    if (options.only) trial.on_frame = print_frame;
    const auto outcome =
        run_relocalization(mapped, again, alignment, trial, options.slam,
                           options.threaded ? slam::MappingMode::kThreaded : slam::MappingMode::kSynchronous);
    const bool met = outcome.found && outcome.after_s <= 1.0 && outcome.error_m <= 0.02 && outcome.error_deg <= 1.0;
    good += met ? 1 : 0;
    std::printf(
        "%2zu map %3zu covered %2zu resume %3zu  %s after %.2f s  error %.4f m %.2f deg  worst %.4f m %.2f deg  wrong "
        "%zu  maps %zu  process %.1f ms  search %.1f ms\n",
        i, trial.mapped, trial.covered, trial.resume, met ? "ok  " : (outcome.found ? "far " : "lost"), outcome.after_s,
        outcome.error_m, outcome.error_deg, outcome.worst_error_m, outcome.worst_error_deg, outcome.wrong, outcome.maps,
        outcome.worst_ms, outcome.worst_search_ms);
    std::fflush(stdout);
  }
  std::printf("%zu of %zu\n", good, options.cuts);
  return good == options.cuts ? 0 : 1;
}
