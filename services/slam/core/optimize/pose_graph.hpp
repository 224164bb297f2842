// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/geometry/se3.hpp"

namespace rtd::slam {

struct PoseGraphNode {
  Eigen::Isometry3d T_world_node = Eigen::Isometry3d::Identity();
  bool fixed = false;  ///< holds the gauge
};

/// What is known of the motion between two nodes.
struct PoseGraphEdge {
  std::uint32_t from = 0, to = 0;  ///< indices into the nodes
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  double sigma_m = 1, sigma_rad = 1;  ///< standard deviations of its translation and rotation
  /// Added to these, where directions are not equally well known: of d = [rho; phi] in T_from_to Exp(d).
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
};

struct PoseGraph {
  std::vector<PoseGraphNode> nodes;
  std::vector<PoseGraphEdge> edges;
};

struct PoseGraphOptions {
  int max_iterations = 30;
  std::function<bool()> interrupted;  ///< polled between iterations; true ends early with what is reached
};

struct PoseGraphSummary {
  bool usable = false;  ///< false: the nodes are as they were
  double initial_cost = 0, final_cost = 0;
  int iterations = 0;
};

/// Moves the nodes to where they contradict the edges least, docs/theory/loop_closing.md Eq. (3)-(5). Without a fixed
/// node the first one is held. Deterministic, one thread (sparse Cholesky).
PoseGraphSummary optimize_pose_graph(PoseGraph& graph, const PoseGraphOptions& options = {});

/// Residual of an edge and its derivatives by right perturbations T Exp(d) of both nodes, without the sigmas;
/// Eq. (3), (4). Public for its test.
struct PoseGraphResidual {
  geometry::Vector6d value = geometry::Vector6d::Zero();  ///< [rho; phi], m and rad
  geometry::Matrix6d by_from = geometry::Matrix6d::Zero(), by_to = geometry::Matrix6d::Zero();
};
PoseGraphResidual evaluate_pose_graph_edge(const Eigen::Isometry3d& T_world_from, const Eigen::Isometry3d& T_world_to,
                                           const Eigen::Isometry3d& T_from_to);

}  // namespace rtd::slam
