// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "services/detector/core/engine.hpp"

namespace rtd::detector {

/// The last layer of a gated output, a 1x1 convolution, computed only where something is. The gates are computed for
/// every cell, the other planes for the cells that pass: a few in ten thousand. That is a tenth of the network's time.
class PointwiseHead {
 public:
  /// `weights` are planes x channels, row-major; there is one bias for each plane.
  PointwiseHead(const float* weights, std::vector<float> bias, std::size_t channels, const GatedOutput& gated);

  std::size_t channels() const { return channels_; }
  std::size_t planes() const { return bias_.size(); }

  /// `features` are channels x cells, `logits` planes x cells. Sets all gates, and the other planes of the cells whose
  /// gate is at least that of the gated output; the rest of `logits` stays as it was.
  void evaluate(const float* features, std::size_t cells, float* logits) const;

 private:
  void evaluate_gates(const float* features, std::size_t cells, float* logits) const;
  void evaluate_cell(const float* features, std::size_t cells, std::size_t group, float* cell_logits) const;

  std::size_t channels_, group_planes_, gate_plane_;
  float least_;
  std::vector<float> bias_;
  std::vector<float> weights_;  ///< group, channel, plane: the planes of a cell are summed side by side
};

/// OpenCV's DNN module on the CPU; `device` names it for people. Throws cv::Exception.
std::unique_ptr<Engine> make_opencv_engine(const EngineModel& model, std::string device);

}  // namespace rtd::detector
