// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/camera/synthetic/scene.hpp"
#include "common/occupancy/navigation_grid.hpp"

namespace rtd::test_support {

/// What a floor plan is worth against the geometry of the scene. Right with a tolerance of one cell: a free cell is
/// wrong when it and all cells around it are solid, an occupied one when there is nothing static in it or around it.
struct GridReport {
  std::size_t free = 0, occupied = 0;                            ///< cells of the plan
  std::size_t wrong_free = 0, wrong_occupied = 0;                ///< of these
  std::size_t ghosts = 0;                                        ///< wrongly occupied where something moved
  std::size_t mostly_wrong_free = 0, wholly_wrong_occupied = 0;  ///< without tolerance: by the cell alone
  std::size_t truly_free = 0, found_free = 0;                    ///< cells without anything in them, and those free
  double share_right() const { return share(wrong_free + wrong_occupied, free + occupied); }
  double share_right_strictly() const { return share(mostly_wrong_free + wholly_wrong_occupied, free + occupied); }
  double share_found() const { return 1 - share(found_free, truly_free); }

 private:
  static double share(std::size_t wrong, std::size_t all) {
    return all == 0 ? 0 : 1 - static_cast<double>(wrong) / static_cast<double>(all);
  }
};

/// The true floor plan of a synthetic source, and where its movers went, between two heights.
class GridTruth {
 public:
  /// `source`: "synthetic:NAME?..."; a plan's frame is the scene's world.
  GridTruth(const std::string& source, double cell_m, const occupancy::RobotHeights& heights);
  GridReport judge(const occupancy::NavigationGrid& grid) const;

 private:
  static constexpr int kSamples = 5;  ///< of a cell, along each axis
  struct Cell {
    int solid = 0;  ///< samples
    bool visited = false;
  };
  bool solid(const camera::synthetic::Geometry& geometry, float x_m, float y_m) const;
  void mark_movers(const camera::synthetic::Geometry& geometry);
  void mark(const Eigen::AlignedBox3f& box);
  const Cell& at(const Eigen::Vector2i& cell) const;
  template <class Is>
  bool all_around(const Eigen::Vector2i& cell, Is is) const;

  double cell_m_;
  occupancy::RobotHeights heights_;
  Eigen::Vector2i first_;
  int columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace rtd::test_support
