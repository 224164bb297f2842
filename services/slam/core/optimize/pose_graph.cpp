// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/optimize/pose_graph.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>

#include "services/slam/core/optimize/interrupt_callback.hpp"

namespace rtd::slam {
namespace {

using geometry::Matrix6d;
using geometry::RowMajor6d;
using geometry::Vector6d;
using RowMajor67d = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;

constexpr int kAmbient = 7, kTangent = 6;

/// A pose as Ceres holds it: translation, then quaternion xyzw.
using PoseBlock = std::array<double, kAmbient>;

PoseBlock to_block(const Eigen::Isometry3d& T) {
  PoseBlock block{};
  Eigen::Map<Eigen::Vector3d>(block.data()) = T.translation();
  Eigen::Map<Eigen::Quaterniond>(block.data() + 3) = Eigen::Quaterniond(T.linear()).normalized();
  return block;
}

Eigen::Isometry3d to_pose(const double* block) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Map<const Eigen::Vector3d>(block);
  T.linear() = Eigen::Map<const Eigen::Quaterniond>(block + 3).normalized().toRotationMatrix();
  return T;
}

/// Poses with the step T Exp(d), loop_closing.md Eq. (4). Costs give their derivatives by the six numbers of `d`
/// already; as Ceres asks for derivatives by the seven stored ones and multiplies those by PlusJacobian(), they stand
/// in the first six of these and PlusJacobian() is the identity with a row of zeros.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kAmbient; }
  int TangentSize() const override { return kTangent; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const PoseBlock moved = to_block(to_pose(x) * geometry::se3_exp(Eigen::Map<const Vector6d>(delta)));
    std::copy(moved.begin(), moved.end(), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kAmbient, kTangent, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d> difference(y_minus_x);
    difference = geometry::se3_log(to_pose(x).inverse() * to_pose(y));
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<RowMajor67d>(jacobian).setIdentity();
    return true;
  }
};

class EdgeCost final : public ceres::SizedCostFunction<kTangent, kAmbient, kAmbient> {
 public:
  explicit EdgeCost(const PoseGraphEdge& edge) : T_from_to_(edge.T_from_to) {
    Vector6d sigmas;
    sigmas << Eigen::Vector3d::Constant(edge.sigma_m), Eigen::Vector3d::Constant(edge.sigma_rad);
    if (edge.covariance.isZero(0)) {
      whitening_.diagonal() = sigmas.cwiseInverse();
    } else {
      const Matrix6d covariance = edge.covariance + Matrix6d(sigmas.cwiseAbs2().asDiagonal());
      whitening_ = covariance.llt().matrixL().solve(Matrix6d::Identity());
    }
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const PoseGraphResidual residual =
        evaluate_pose_graph_edge(to_pose(parameters[0]), to_pose(parameters[1]), T_from_to_);
    const Vector6d whitened = whitening_ * residual.value;
    std::copy_n(whitened.data(), kTangent, residuals);
    if (jacobians == nullptr) return true;
    const auto write = [&](double* out, const Matrix6d& J) {
      if (out == nullptr) return;
      Eigen::Map<RowMajor67d> jacobian(out);
      jacobian.setZero();
      jacobian.leftCols<6>() = whitening_ * J;
    };
    write(jacobians[0], residual.by_from);
    write(jacobians[1], residual.by_to);
    return true;
  }

 private:
  Eigen::Isometry3d T_from_to_;
  Matrix6d whitening_ = Matrix6d::Zero();
};

/// ad of a twist: [[phi]x, [rho]x; 0, [phi]x].
Matrix6d adjoint_of_twist(const Vector6d& twist) {
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = geometry::skew(twist.tail<3>());
  ad.topRightCorner<3, 3>() = geometry::skew(twist.head<3>());
  return ad;
}

/// Inverse right Jacobian of SE(3), loop_closing.md Eq. (5): Log(E Exp(d)) = Log(E) + J d.
Matrix6d inverse_right_jacobian(const Vector6d& twist) {
  const Matrix6d ad = adjoint_of_twist(twist), ad2 = ad * ad;
  return Matrix6d::Identity() + 0.5 * ad + ad2 / 12.0 - ad2 * ad2 / 720.0 + ad2 * ad2 * ad2 / 30240.0;
}

}  // namespace

PoseGraphResidual evaluate_pose_graph_edge(const Eigen::Isometry3d& T_world_from, const Eigen::Isometry3d& T_world_to,
                                           const Eigen::Isometry3d& T_from_to) {
  PoseGraphResidual residual;
  const Eigen::Isometry3d T_to_from = T_world_to.inverse() * T_world_from;
  residual.value = geometry::se3_log(T_from_to.inverse() * T_to_from.inverse());
  residual.by_to = inverse_right_jacobian(residual.value);
  residual.by_from = -residual.by_to * geometry::adjoint(T_to_from);
  return residual;
}

PoseGraphSummary optimize_pose_graph(PoseGraph& graph, const PoseGraphOptions& options) {
  if (graph.nodes.empty() || graph.edges.empty()) return {};
  ceres::Problem problem;
  auto* manifold = new PoseManifold;  // owned by the problem
  std::vector<PoseBlock> blocks;
  blocks.reserve(graph.nodes.size());
  for (const PoseGraphNode& node : graph.nodes) {
    blocks.push_back(to_block(node.T_world_node));
    problem.AddParameterBlock(blocks.back().data(), kAmbient, manifold);
    if (node.fixed) problem.SetParameterBlockConstant(blocks.back().data());
  }
  if (std::none_of(graph.nodes.begin(), graph.nodes.end(), [](const PoseGraphNode& node) { return node.fixed; })) {
    problem.SetParameterBlockConstant(blocks.front().data());
  }
  for (const PoseGraphEdge& edge : graph.edges) {
    problem.AddResidualBlock(new EdgeCost(edge), nullptr, blocks[edge.from].data(), blocks[edge.to].data());
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // not CHOLMOD, parts of which are GPL
  solver.max_num_iterations = options.max_iterations;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  InterruptCallback interrupt(options.interrupted);
  solver.callbacks.push_back(&interrupt);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable()) return {};
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!graph.nodes[i].fixed) graph.nodes[i].T_world_node = to_pose(blocks[i].data());
  }
  return {true, summary.initial_cost, summary.final_cost, static_cast<int>(summary.iterations.size())};
}

}  // namespace rtd::slam
