// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/iteration_callback.h>

#include <functional>

namespace rtd::slam {

/// Ends a solver of Ceres when another keyframe waits for the mapper: polled after each iteration.
class InterruptCallback final : public ceres::IterationCallback {
 public:
  explicit InterruptCallback(const std::function<bool()>& interrupted) : interrupted_(interrupted) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return interrupted_ && interrupted_() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()>& interrupted_;
};

}  // namespace rtd::slam
