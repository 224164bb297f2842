// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/optimize/dense_bundle.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rtd::slam {
namespace {

using geometry::Matrix6d;
using geometry::Vector6d;

constexpr std::size_t kLandmarksBetweenQuestions = 32;  ///< some 0.1 ms
constexpr double kFunctionTolerance = 1e-4;
constexpr double kMinGainRatio = 1e-3;  ///< of a step that is taken

struct Robust {
  double rho, slope;  ///< of the squared residual
};

Robust huber(double squared, double limit) {
  if (squared <= limit) return {squared, 1.0};
  const double root = std::sqrt(limit * squared);
  return {2 * root - limit, root / squared};
}

Eigen::Isometry3d moved_pose(const Eigen::Isometry3d& T_camera_world, const Vector6d& step) {
  Eigen::Isometry3d moved = T_camera_world;
  moved.linear() = geometry::so3_exp(step.tail<3>()) * moved.linear();
  moved.translation() += step.head<3>();
  return moved;
}

/// factor A'A of a Jacobian whose first two rows know nothing of each other's direction and whose third is along z.
Eigen::Matrix3d normal_matrix(const Eigen::Matrix3d& A, double factor) {
  const double xz = factor * A(0, 0) * A(0, 2), yz = factor * A(1, 1) * A(1, 2);
  Eigen::Matrix3d M;
  M << factor * A(0, 0) * A(0, 0), 0, xz,  //
      0, factor * A(1, 1) * A(1, 1), yz,   //
      xz, yz, factor * A.col(2).squaredNorm();
  return M;
}

/// skew(p) M.
Eigen::Matrix3d crossed(const Eigen::Vector3d& p, const Eigen::Matrix3d& M) {
  Eigen::Matrix3d product;
  for (int column = 0; column < 3; ++column) product.col(column) = p.cross(M.col(column));
  return product;
}

/// Marquardt's damping: every diagonal element grows by the same factor.
template <class Matrix>
Matrix damped(const Matrix& H, double damping) {
  Matrix sum = H;
  sum.diagonal() *= 1 + damping;
  return sum;
}

}  // namespace

DenseBundle::DenseBundle(BundleProblem& problem, const BundleOptions& options) : problem_(problem), options_(options) {
  const bool held = std::any_of(problem.cameras.begin(), problem.cameras.end(), [](const auto& c) { return c.fixed; });
  int free = 0;
  for (std::size_t i = 0; i < problem.cameras.size(); ++i) {
    const bool fixed = problem.cameras[i].fixed || (!held && i == 0);
    free_index_.push_back(fixed ? kFixed : free++);
  }
  first_.assign(problem.points.size() + 1, 0);
  for (const BundleObservation& observation : problem.observations) {
    if (observation.inlier) ++first_[observation.point + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  ordered_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < problem.observations.size(); ++i) {
    if (problem.observations[i].inlier) ordered_[next[problem.observations[i].point]++] = i;
  }
  B_.resize(static_cast<std::size_t>(free));
  v_.resize(B_.size());
  C_.resize(problem.points.size());
  C_inverse_.resize(C_.size());
  w_.resize(C_.size());
  E_.resize(ordered_.size());
  S_.resize(6 * free, 6 * free);
  s_.resize(6 * free);
}

BundleSummary DenseBundle::solve(int max_iterations, RobustLoss loss) {
  State state;
  for (const BundleCamera& camera : problem_.cameras) state.T_camera_world.push_back(camera.T_world_camera.inverse());
  state.points = problem_.points;
  BundleSummary summary;
  if (ordered_.empty() || !linearize(state, loss)) return summary;
  summary.iterations = 1;
  summary.initial_cost = state.cost;
  double radius = 1e4, shrink = 2;  // as Ceres' trust region
  Step step;
  while (summary.iterations <= max_iterations && solve_step(1 / radius, step)) {
    State candidate = moved(state, step);
    if (!linearize(candidate, loss)) break;
    ++summary.iterations;
    const double decrease = state.cost - candidate.cost;
    const bool converged = std::abs(decrease) <= kFunctionTolerance * state.cost;
    const double gain_ratio = decrease / step.expected_decrease;
    if (gain_ratio > kMinGainRatio) {
      state = std::move(candidate);
      radius /= std::max(1.0 / 3, 1 - std::pow(2 * gain_ratio - 1, 3));
      shrink = 2;
    } else {
      radius /= shrink;
      shrink *= 2;
      if (!converged && !linearize(state, loss)) break;
    }
    if (converged) break;
  }
  summary.final_cost = state.cost;
  for (std::size_t i = 0; i < problem_.cameras.size(); ++i) {
    if (free_index_[i] == kFixed) continue;
    problem_.cameras[i].T_world_camera = geometry::normalized(state.T_camera_world[i]).inverse();
  }
  problem_.points = std::move(state.points);
  return summary;
}

/// Cost, gradient and Gauss-Newton Hessian at a state. False when interrupted: the sums are incomplete then.
bool DenseBundle::linearize(State& state, RobustLoss loss) {
  std::fill(B_.begin(), B_.end(), Matrix6d::Zero());
  std::fill(v_.begin(), v_.end(), Vector6d::Zero());
  double cost = 0;
  for (std::size_t point = 0; point < C_.size(); ++point) {
    if (point % kLandmarksBetweenQuestions == 0 && interrupted()) return false;
    C_[point].setZero();
    w_[point].setZero();
    for (std::size_t place = first_[point]; place < first_[point + 1]; ++place) {
      add(problem_.observations[ordered_[place]], place, state, loss, cost);
    }
  }
  state.cost = cost;
  return true;
}

/// One observation's share, docs/theory/mapping.md Eq. (7): with M = w rho' / sigma^2 A'A and A the derivative of the
/// residual by p_camera, everything else follows from M by the derivatives of p_camera.
void DenseBundle::add(const BundleObservation& observation, std::size_t place, const State& state, RobustLoss loss,
                      double& cost) {
  const Eigen::Isometry3d& T_camera_world = state.T_camera_world[observation.camera];
  const Eigen::Matrix3d R = T_camera_world.linear();
  const Eigen::Vector3d p_rotated = R * state.points[observation.point];
  const Eigen::Vector3d p_camera = p_rotated + T_camera_world.translation();
  const vision::RgbdProjection& projection = problem_.projection_of(observation);
  const double limit = observation.measured.has_depth() ? options_.max_chi2_rgbd : options_.max_chi2_pixel;
  const bool in_front = p_camera.z() >= vision::kMinProjectionDepth_m;
  const double inverse_variance = 1 / (observation.sigma_px * observation.sigma_px);
  const Eigen::Vector3d residual =
      in_front ? vision::rgbd_residual(projection, p_camera, observation.measured) : Eigen::Vector3d::Zero();
  const double squared = in_front ? residual.squaredNorm() * inverse_variance
                                  : observation.measured.dimension() * kBehindCameraResidual * kBehindCameraResidual;
  const Robust robust = loss == RobustLoss::kHuber ? huber(squared, limit) : Robust{squared, 1.0};
  cost += 0.5 * observation.weight * robust.rho;
  const int camera = free_index_[observation.camera];
  if (!in_front) {
    E_[place].setZero();
    return;
  }
  const Eigen::Matrix3d A = vision::rgbd_jacobian(projection, p_camera, observation.measured);
  const double factor = observation.weight * robust.slope * inverse_variance;
  const Eigen::Matrix3d M = normal_matrix(A, factor);
  const Eigen::Vector3d g = factor * A.transpose() * residual;
  const Eigen::Matrix3d MR = M * R;
  C_[observation.point].noalias() += R.transpose() * MR;
  w_[observation.point].noalias() += R.transpose() * g;
  if (camera == kFixed) return;
  const Eigen::Matrix3d turn_M = crossed(p_rotated, M);  // dp_camera/dphi = -skew(p_rotated)
  Matrix6d& B = B_[static_cast<std::size_t>(camera)];    // the lower triangle
  B.topLeftCorner<3, 3>() += M;
  B.bottomLeftCorner<3, 3>() += turn_M;
  B.bottomRightCorner<3, 3>() += crossed(p_rotated, turn_M.transpose());
  Vector6d& v = v_[static_cast<std::size_t>(camera)];
  v.head<3>() += g;
  v.tail<3>() += p_rotated.cross(g);
  E_[place].topRows<3>() = MR;
  E_[place].bottomRows<3>() = crossed(p_rotated, MR);
}

/// S = B - E C^-1 E' and s = v - E C^-1 w, Eq. (3), both with damping. False when interrupted.
bool DenseBundle::eliminate_points(double damping) {
  S_.setZero();
  for (std::size_t i = 0; i < B_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    S_.block<6, 6>(row, row) = damped(B_[i], damping);
    s_.segment<6>(row) = v_[i];
  }
  for (std::size_t point = 0; point < C_.size(); ++point) {
    if (point % kLandmarksBetweenQuestions == 0 && interrupted()) return false;
    C_inverse_[point] = damped(C_[point], damping).inverse();
    // A point that its views do not determine stays where it is.
    if (!C_inverse_[point].allFinite()) C_inverse_[point].setZero();
    for (std::size_t a = first_[point]; a < first_[point + 1]; ++a) {
      const int i = free_index_[problem_.observations[ordered_[a]].camera];
      if (i == kFixed) continue;
      const Matrix63d EC = E_[a] * C_inverse_[point];
      s_.segment<6>(6 * i).noalias() -= EC * w_[point];
      for (std::size_t b = first_[point]; b < first_[point + 1]; ++b) {
        const int j = free_index_[problem_.observations[ordered_[b]].camera];
        if (j == kFixed || j > i) continue;
        S_.block<6, 6>(6 * i, 6 * j).noalias() -= EC * E_[b].transpose();
      }
    }
  }
  return true;
}

/// The step of Eq. (3), points by Eq. (8). False when interrupted or when there is none.
bool DenseBundle::solve_step(double damping, Step& step) {
  if (!eliminate_points(damping)) return false;
  const auto decomposition = S_.selfadjointView<Eigen::Lower>().llt();
  if (decomposition.info() != Eigen::Success) return false;
  const Eigen::VectorXd cameras = decomposition.solve(-s_);
  step.cameras.resize(B_.size());
  step.points.resize(C_.size());
  double expected = 0;  // Eq. (9)
  for (std::size_t i = 0; i < B_.size(); ++i) {
    const Vector6d& delta = step.cameras[i] = cameras.segment<6>(static_cast<Eigen::Index>(6 * i));
    expected += damping * delta.dot(B_[i].diagonal().cwiseProduct(delta)) - delta.dot(v_[i]);
  }
  for (std::size_t point = 0; point < C_.size(); ++point) {
    Eigen::Vector3d pull = -w_[point];
    for (std::size_t a = first_[point]; a < first_[point + 1]; ++a) {
      const int i = free_index_[problem_.observations[ordered_[a]].camera];
      if (i != kFixed) pull.noalias() -= E_[a].transpose() * step.cameras[static_cast<std::size_t>(i)];
    }
    const Eigen::Vector3d& delta = step.points[point] = C_inverse_[point] * pull;
    expected += damping * delta.dot(C_[point].diagonal().cwiseProduct(delta)) - delta.dot(w_[point]);
  }
  step.expected_decrease = 0.5 * expected;
  return true;
}

DenseBundle::State DenseBundle::moved(const State& state, const Step& step) const {
  State candidate = state;
  for (std::size_t i = 0; i < candidate.T_camera_world.size(); ++i) {
    if (free_index_[i] == kFixed) continue;
    candidate.T_camera_world[i] =
        moved_pose(state.T_camera_world[i], step.cameras[static_cast<std::size_t>(free_index_[i])]);
  }
  for (std::size_t i = 0; i < candidate.points.size(); ++i) candidate.points[i] += step.points[i];
  return candidate;
}

}  // namespace rtd::slam
