// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <mutex>

namespace rtd::detector {

/// values[i] = 1 / (1 + exp(-values[i])), vectorised; relative error below 1e-6. OpenCV 4.6 calls std::exp per element,
/// a seventh of the time of YOLOX-nano. `out` may be `in`.
void sigmoid(const float* in, float* out, std::size_t count);

/// While one exists, networks that are loaded get the vectorised Sigmoid layer. The registry of layer types is the
/// process's: another thread waits until it has gone.
class FastSigmoidScope {
 public:
  FastSigmoidScope();
  ~FastSigmoidScope();
  FastSigmoidScope(const FastSigmoidScope&) = delete;
  FastSigmoidScope& operator=(const FastSigmoidScope&) = delete;

 private:
  std::unique_lock<std::mutex> registry_;
};

}  // namespace rtd::detector
