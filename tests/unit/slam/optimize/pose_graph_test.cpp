// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/optimize/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rtd::slam {
namespace {

using geometry::Matrix6d;
using geometry::Vector6d;

constexpr int kNodes = 120;
constexpr double kCircleRadiusM = 10;

/// A camera that walks a circle, looking ahead, and ends where it began.
Eigen::Isometry3d pose_on_circle(int i) {
  const double angle_rad = 2 * std::numbers::pi * i / kNodes;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation() = kCircleRadiusM * Eigen::Vector3d(1 - std::cos(angle_rad), 0.02 * i, std::sin(angle_rad));
  return T;
}

Eigen::Isometry3d truth_between(int from, int to) {
  return pose_on_circle(from).inverse() * pose_on_circle(to);
}

/// The circle as odometry with a constant error of each step sees it.
PoseGraph drifted_circle(const Vector6d& step_error) {
  PoseGraph graph;
  graph.nodes.push_back({pose_on_circle(0), true});
  for (int i = 1; i < kNodes; ++i) {
    const Eigen::Isometry3d T_step = truth_between(i - 1, i) * geometry::se3_exp(step_error);
    graph.nodes.push_back({graph.nodes.back().T_world_node * T_step, false});
    graph.edges.push_back({static_cast<std::uint32_t>(i - 1), static_cast<std::uint32_t>(i), T_step, 0.01, 0.005});
  }
  return graph;
}

void close_with_truth(PoseGraph& graph) {
  graph.edges.push_back({0, kNodes - 1, truth_between(0, kNodes - 1), 1e-4, 1e-4});
}

double worst_error_m(const PoseGraph& graph) {
  double worst_m = 0;
  for (int i = 0; i < kNodes; ++i) {
    const auto& node = graph.nodes[static_cast<std::size_t>(i)];
    worst_m = std::max(worst_m, (node.T_world_node.translation() - pose_on_circle(i).translation()).norm());
  }
  return worst_m;
}

Vector6d step_error() {
  Vector6d error;
  error << 0.002, -0.001, 0.003, 0.0005, -0.002, 0.0007;
  return error;
}

Vector6d random_twist(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> number(-size, size);
  return Vector6d::NullaryExpr([&] { return number(random); });
}

TEST(PoseGraph, analytic_derivatives_are_those_of_the_residual) {
  constexpr double kStep = 1e-6;
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Isometry3d T_from = geometry::se3_exp(random_twist(random, 2)),
                            T_to = geometry::se3_exp(random_twist(random, 2));
    const Eigen::Isometry3d T_from_to = T_from.inverse() * T_to * geometry::se3_exp(random_twist(random, 0.3));
    const PoseGraphResidual at = evaluate_pose_graph_edge(T_from, T_to, T_from_to);
    for (int k = 0; k < 6; ++k) {
      const Eigen::Isometry3d forth = geometry::se3_exp(kStep * Vector6d::Unit(k)), back = forth.inverse();
      const Vector6d by_from = (evaluate_pose_graph_edge(T_from * forth, T_to, T_from_to).value -
                                evaluate_pose_graph_edge(T_from * back, T_to, T_from_to).value) /
                               (2 * kStep);
      const Vector6d by_to = (evaluate_pose_graph_edge(T_from, T_to * forth, T_from_to).value -
                              evaluate_pose_graph_edge(T_from, T_to * back, T_from_to).value) /
                             (2 * kStep);
      EXPECT_LT((at.by_from.col(k) - by_from).norm(), 1e-6);
      EXPECT_LT((at.by_to.col(k) - by_to).norm(), 1e-6);
    }
  }
}

TEST(PoseGraph, a_loop_takes_the_drift_out_of_a_circle) {
  PoseGraph graph = drifted_circle(step_error());
  const double before_m = worst_error_m(graph);
  close_with_truth(graph);
  const PoseGraphSummary summary = optimize_pose_graph(graph);
  ASSERT_TRUE(summary.usable);
  EXPECT_GT(before_m, 0.5);
  EXPECT_LT(worst_error_m(graph), 0.1 * before_m);
  EXPECT_LT(summary.final_cost, 1e-2 * summary.initial_cost);
}

TEST(PoseGraph, a_graph_without_contradiction_stays_as_it_is) {
  PoseGraph graph = drifted_circle(Vector6d::Zero());
  close_with_truth(graph);
  ASSERT_TRUE(optimize_pose_graph(graph).usable);
  EXPECT_LT(worst_error_m(graph), 1e-9);
}

TEST(PoseGraph, strong_edges_bend_less_than_weak_ones) {
  PoseGraph graph = drifted_circle(step_error());
  for (PoseGraphEdge& edge : graph.edges) {
    if (edge.from >= kNodes / 2) {
      edge.sigma_m *= 100;
      edge.sigma_rad *= 100;
    }
  }
  close_with_truth(graph);
  ASSERT_TRUE(optimize_pose_graph(graph).usable);
  const auto bent = [&](std::size_t i) {
    const PoseGraphEdge& edge = graph.edges[i];
    return evaluate_pose_graph_edge(graph.nodes[edge.from].T_world_node, graph.nodes[edge.to].T_world_node,
                                    edge.T_from_to)
        .value.norm();
  };
  EXPECT_LT(100 * bent(10), bent(kNodes - 10));
}

TEST(PoseGraph, fixed_nodes_hold_the_gauge) {
  PoseGraph graph = drifted_circle(step_error());
  const Eigen::Isometry3d T_shift = geometry::se3_exp(Vector6d::Constant(0.4));
  PoseGraph shifted = graph;
  for (PoseGraphNode& node : shifted.nodes) node.T_world_node = T_shift * node.T_world_node;
  close_with_truth(graph);
  close_with_truth(shifted);
  shifted.nodes.front().fixed = false;  // the first is held when nothing is
  ASSERT_TRUE(optimize_pose_graph(graph).usable && optimize_pose_graph(shifted).usable);
  EXPECT_TRUE(graph.nodes.front().T_world_node.isApprox(pose_on_circle(0), 0));
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    EXPECT_TRUE(shifted.nodes[i].T_world_node.isApprox(T_shift * graph.nodes[i].T_world_node, 1e-6)) << i;
  }
}

TEST(PoseGraph, the_same_graph_gives_the_same_bits) {
  PoseGraph first = drifted_circle(step_error()), second = first;
  close_with_truth(first);
  close_with_truth(second);
  optimize_pose_graph(first);
  optimize_pose_graph(second);
  for (std::size_t i = 0; i < first.nodes.size(); ++i) {
    EXPECT_EQ(first.nodes[i].T_world_node.matrix(), second.nodes[i].T_world_node.matrix());
  }
}

TEST(PoseGraph, interrupted_it_ends_early) {
  PoseGraph graph = drifted_circle(step_error());
  close_with_truth(graph);
  PoseGraphOptions options;
  options.interrupted = [] { return true; };
  EXPECT_LE(optimize_pose_graph(graph, options).iterations, 2);
}

TEST(PoseGraph, nothing_to_do_is_no_failure_of_others) {
  PoseGraph empty;
  EXPECT_FALSE(optimize_pose_graph(empty).usable);
}

/// Two measurements of one motion, each of which knows another direction well.
TEST(PoseGraph, an_edge_counts_where_it_knows_something) {
  constexpr double kWrong_m = 0.1, kUnknown2 = 1;
  PoseGraph graph;
  graph.nodes = {{pose_on_circle(0), true}, {pose_on_circle(5), false}};
  for (const int unknown : {0, 1}) {
    Vector6d wrong = Vector6d::Zero();
    wrong[unknown] = kWrong_m;
    graph.edges.push_back({0, 1, truth_between(0, 5) * geometry::se3_exp(wrong), 0.001, 0.001});
    graph.edges.back().covariance(unknown, unknown) = kUnknown2;
  }
  ASSERT_TRUE(optimize_pose_graph(graph).usable);
  EXPECT_LT((graph.nodes[1].T_world_node.translation() - pose_on_circle(5).translation()).norm(), 1e-3);
}

}  // namespace
}  // namespace rtd::slam
