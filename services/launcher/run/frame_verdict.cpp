// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/frame_verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/camera/live_uri.hpp"

namespace rtd::launcher {
namespace {

struct Cause {
  double frames = 0;
  std::string name;  ///< as in the report
  std::string text;  ///< what is wrong and what helps
};

std::vector<Cause> causes_of(const run_record::RunRecord& record) {
  std::vector<Cause> causes;
  for (const auto& [name, count] : record.left_out)
    if (const auto reason = camera::skip_reason_of(name)) causes.push_back({count, name, camera::explain(*reason)});
  causes.push_back(
      {static_cast<double>(record.frames_not_played), "not_played", "the run ended before them: the events say why"});
  double late = 0;
  if (const auto found = record.drops.find("camera.late"); found != record.drops.end()) late = found->second;
  causes.push_back({late, "late",
                    "they came too late for pace realtime: --pace lockstep plays every frame, a smaller image or a "
                    "lower rate costs less"});
  causes.push_back({static_cast<double>(record.frames_dropped) - late, "without_answer",
                    "slam gave no result for them: logs/slam.log and logs/filter.log say more"});
  causes.push_back({static_cast<double>(record.frames_out_of_range), "out_of_range",
                    "no pixel has a depth between 0.1 and 20 m: is the unit of depth right (depth_factor in the "
                    "calibration), is the sensor covered?"});
  return causes;
}

const char* const kOtherCamera = camera::to_string(camera::SkipReason::kOtherCamera);

std::vector<std::string> deaths_on_the_way(const run_record::RunRecord& record) {
  return run_record::deaths(record, {"camera", "filter", "slam"});
}

}  // namespace

bool died_with_frames(const run_record::RunRecord& record) {
  if (camera::is_live(record.source) && !run_record::deaths(record, {"camera"}).empty()) return true;
  return record.frames_dropped + record.frames_not_played > 0 && !deaths_on_the_way(record).empty();
}

bool is_partial(const run_record::RunRecord& record) {
  return run_record::frame_use(record).too_few() || died_with_frames(record) || record.left_out.contains(kOtherCamera);
}

std::string why_not_used(const run_record::RunRecord& record, const std::string& first_left_out) {
  const run_record::FrameUse use = run_record::frame_use(record);
  if (died_with_frames(record))
    return fmt::format("only {} of {} frames were used: {}", use.used, use.given,
                       fmt::join(deaths_on_the_way(record), "; "));
  const std::vector<Cause> causes = causes_of(record);
  const auto other = std::ranges::find(causes, kOtherCamera, &Cause::name);
  if (other == causes.end() && 10 * use.used >= 9 * use.given) return {};
  const Cause most = other == causes.end() ? *std::ranges::max_element(causes, {}, &Cause::frames) : *other;
  std::string text = fmt::format("only {} of {} frames were used; {:.0f} x {}: {}", use.used, use.given, most.frames,
                                 most.name, most.text);
  if (record.left_out.contains(most.name) && !first_left_out.empty())
    text += fmt::format(" (first left out: {})", first_left_out);
  return text;
}

}  // namespace rtd::launcher
