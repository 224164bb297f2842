// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/ros.hpp"
#include "common/vision/frame_view.hpp"
#include "services/filter/core/dynamic_filter.hpp"

namespace rtd::filter {

using vision::defect;
using vision::view_image;

/// Fills a feature message. Of more than kMaxFeatures features, the removed ones are left out first.
void fill_message(const msg::RgbdFrame& frame, const FilterResult& result, msg::DetectionUse use,
                  msg::FeatureFrame& message);

/// What moves, as a grey picture of grid cells (4x4 undistorted pixels each) with the values of CellMotion and the
/// stamp of the frame. In mode off, which takes everything to be static, all cells say so.
msg::Image make_mask(const msg::RgbdFrame& frame, const FilterResult& result);

}  // namespace rtd::filter
