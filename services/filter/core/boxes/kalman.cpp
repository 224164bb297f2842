// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/kalman.hpp"

#include <algorithm>

namespace rtd::filter {
namespace {

// Noise in units of the box's own size, so that near and far objects are treated alike.
constexpr double kDetection = 0.05;     ///< standard deviation of a detected edge
constexpr double kAcceleration = 4.0;   ///< of an object, box sizes / s^2
constexpr double kFlow = 0.01;          ///< of a shift by optical flow from image to image
constexpr double kFirstVelocity = 1.5;  ///< of a box seen once, box sizes / s

constexpr double kMinUnitPx = 8;  // boxes smaller than this are measured no better

std::array<double, 4> numbers_of(const Box& box) {
  return {box.centre_px.x(), box.centre_px.y(), box.size_px.x(), box.size_px.y()};
}

}  // namespace

Box box_of(const vision::Detection& d) {
  return {{d.x_px + 0.5 * static_cast<double>(d.width_px), d.y_px + 0.5 * static_cast<double>(d.height_px)},
          {d.width_px, d.height_px}};
}

double visible_share(const Box& box, const Eigen::Vector2d& image_px) {
  const Eigen::Vector2d first = (box.centre_px - 0.5 * box.size_px).cwiseMax(0.0).cwiseMin(image_px);
  const Eigen::Vector2d last = (box.centre_px + 0.5 * box.size_px).cwiseMax(0.0).cwiseMin(image_px);
  return (last - first).prod() / std::max(1.0, box.area_px2());
}

double intersection_over_union(const Box& a, const Box& b) {
  const Eigen::Vector2d first = (a.centre_px - 0.5 * a.size_px).cwiseMax(b.centre_px - 0.5 * b.size_px);
  const Eigen::Vector2d last = (a.centre_px + 0.5 * a.size_px).cwiseMin(b.centre_px + 0.5 * b.size_px);
  const double shared = (last - first).cwiseMax(0.0).prod();
  const double joint = a.area_px2() + b.area_px2() - shared;
  return joint > 0 ? shared / joint : 0.0;
}

BoxKalman::BoxKalman(const Box& first) {
  const std::array<double, 4> numbers = numbers_of(first);
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].state[0] = numbers[i];
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double position = kDetection * unit_px(i), velocity = kFirstVelocity * unit_px(i);
    axes_[i].covariance = Eigen::Vector2d(position * position, velocity * velocity).asDiagonal();
  }
}

double BoxKalman::unit_px(std::size_t axis) const {
  return std::max(kMinUnitPx, axes_[2 + axis % 2].state[0]);
}

void BoxKalman::predict(double dt_s) {
  if (dt_s <= 0) return;
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].predict(dt_s, kAcceleration * unit_px(i));
  for (std::size_t i : {2, 3}) axes_[i].state[0] = std::max(1.0, axes_[i].state[0]);
}

void BoxKalman::detected(const Box& measured) {
  const std::array<double, 4> numbers = numbers_of(measured);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].update({1, 0}, numbers[i], kDetection * unit_px(i));
  }
}

void BoxKalman::flowed(const BoxFlow& flow, double dt_s) {
  if (dt_s <= 0) return;
  const Box now = box();
  const std::array<double, 4> shift{flow.shift_px.x(), flow.shift_px.y(), (flow.scale - 1) * now.size_px.x(),
                                    (flow.scale - 1) * now.size_px.y()};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].update({0, 1}, shift[i] / dt_s, kFlow * unit_px(i) / dt_s);
  }
}

Box BoxKalman::box() const {
  return {{axes_[0].state[0], axes_[1].state[0]}, {axes_[2].state[0], axes_[3].state[0]}};
}

double BoxKalman::sigma_px(std::size_t axis) const {
  return std::sqrt(axes_[axis].covariance(0, 0));
}

}  // namespace rtd::filter
