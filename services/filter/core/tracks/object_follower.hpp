// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/vision/motion_levels.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/motion/view_store.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"
#include "services/filter/core/tracks/box_tracks.hpp"
#include "services/filter/core/tracks/detection_batch.hpp"
#include "services/filter/core/tracks/mask_flow.hpp"

namespace rtd::filter {

/// Makes of what the detector says, early, late or not at all, the boxes of every frame (DESIGN section 4 rule 5): box
/// tracks, moved by optical flow of the features on the object where no detection came.
class ObjectFollower {
 public:
  explicit ObjectFollower(const FilterConfig& config);

  /// Once per frame, in order of time. `grid` is this frame's, `views` are the earlier frames.
  std::vector<ObjectBox> follow(const DetectorWord& word, const vision::RgbdImage& image, const DepthGrid& grid,
                                const ViewStore& views);
  /// The depths that the masks of this frame were found at: where the objects are expected next.
  void learn_depths(const std::vector<SceneObject>& objects, const DepthGrid& grid);
  void clear();

 private:
  std::optional<CarriedBox> measure(const CarryStep& step, const vision::RgbdImage& image, const DepthGrid& grid,
                                    const ViewStore& views);

  BoxTrackConfig config_;
  MaskConfig masks_;
  bool use_tracks_, use_flow_, distrust_roll_;
  MotionLevels levels_;
  BoxTracks tracks_;
  MaskFlow flow_;
  std::int64_t watched_ns_ = 0;  ///< stamp of the last frame for which somebody looked
};

/// How fast the camera turned about its optical axis between the last two views, rad/s.
double roll_rate_rad_s(const ViewStore& views);

}  // namespace rtd::filter
