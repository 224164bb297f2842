// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/surface_questions.hpp"

#include <cmath>
#include <cstdlib>

namespace rtd::filter {
namespace {

// Notes of a cell: nothing, known to rest, or in question, with the votes so far: kEven + (moves - rests).
constexpr std::uint8_t kNothing = 0, kRests = 1, kEven = 10;
constexpr int kEnoughVotes = 2;

bool is_open(std::uint8_t note) {
  return note > kRests;
}

/// Per cluster, moves - rests so far: the mean over its cells.
std::vector<int> votes_before(const CellMask& notes, const CellMask& open, const DepthClusters& clusters) {
  std::vector<int> sum(clusters.cells.size(), 0), cells(sum);
  for (std::size_t cell = 0; cell < notes.size(); ++cell) {
    const std::int32_t label = clusters.label[cell];
    if (label < 0 || open[cell] == 0 || !is_open(notes[cell])) continue;
    sum[static_cast<std::size_t>(label)] += notes[cell] - kEven;
    ++cells[static_cast<std::size_t>(label)];
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (cells[i] > 0) sum[i] = static_cast<int>(std::lround(static_cast<double>(sum[i]) / cells[i]));
  }
  return sum;
}

}  // namespace

void SurfaceQuestions::recall(const DepthGrid& grid, const geometry::CameraModel& camera,
                              const Eigen::Isometry3d& T_current_last, double elapsed_s) {
  notes_ = memory_.recall(grid, camera, T_current_last, elapsed_s);
}

Questions SurfaceQuestions::ask(const Surroundings& surroundings, const CellMask& excluded, double min_step_m) {
  notes_.resize(excluded.size(), kNothing);
  CellMask asked(notes_.size(), 0), decided(asked);
  for (std::size_t cell = 0; cell < notes_.size(); ++cell) {
    asked[cell] = is_open(notes_[cell]) ? 1 : 0;
    decided[cell] = notes_[cell] == kRests ? 1 : 0;
  }
  Questions questions{surfaces_in_question(surroundings, {excluded, asked, decided}, min_step_m),
                      CellMask(notes_.size(), 0)};
  for (std::size_t cell = 0; cell < notes_.size(); ++cell) {
    if (questions.open[cell] == 0) {
      if (is_open(notes_[cell])) notes_[cell] = kNothing;
    } else if (!is_open(notes_[cell])) {
      notes_[cell] = kEven;
    }
  }
  return questions;
}

void SurfaceQuestions::answer(Questions& questions, const DepthClusters& clusters,
                              const std::vector<SurfaceVote>& votes) {
  const std::vector<int> before = votes_before(notes_, questions.open, clusters);
  for (std::size_t cell = 0; cell < notes_.size(); ++cell) {
    if (questions.open[cell] == 0 || clusters.label[cell] < 0) continue;
    const auto cluster = static_cast<std::size_t>(clusters.label[cell]);
    const int sum = before[cluster] + static_cast<int>(votes[cluster]);
    notes_[cell] = static_cast<std::uint8_t>(kEven + sum);
    if (std::abs(sum) < kEnoughVotes) continue;
    questions.open[cell] = 0;
    questions.moving[cell] = sum > 0 ? 1 : 0;
    notes_[cell] = sum > 0 ? kNothing : kRests;
  }
}

void SurfaceQuestions::store(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays) {
  memory_.store(grid, rays, notes_);
  notes_.clear();
}

void SurfaceQuestions::clear() {
  memory_.clear();
  notes_.clear();
}

}  // namespace rtd::filter
