// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::filter {

/// Noise in units of the box's own size, so that near and far objects are treated alike.
struct BoxNoise {
  double detection = 0.05;
  double acceleration = 4.0;
  double flow = 0.01;
  double first_velocity = 1.5;

  void bind(auto& binder) {
    binder.field("detection_noise", detection, {0.001, 1.0}, "standard deviation of a detected edge, box sizes");
    binder.field("acceleration", acceleration, {0.01, 100.0}, "of an object, box sizes / s^2");
    binder.field("flow_noise", flow, {0.0001, 1.0}, "of a shift by optical flow from image to image, box sizes");
    binder.field("first_velocity", first_velocity, {0.01, 100.0}, "of a box seen once, box sizes / s");
  }
};

/// The life of box tracks; docs/theory/dynamic_points.md section 6.
struct BoxTrackConfig {
  BoxNoise noise;
  double min_overlap = 0.15;
  double max_match_cost = 1.0;
  int confirm_hits = 2;
  double survive_misses_s = 0.5;
  double silence_s = 1.5;
  double unwatched_s = 0.5;

  void bind(auto& binder) {
    noise.bind(binder);
    binder.field("min_overlap", min_overlap, {0.0, 1.0},
                 "intersection over union of a track and a detection; less: "
                 "not the same object");
    binder.field("max_match_cost", max_match_cost, {0.1, 2.0},
                 "1 - overlap, plus another class and another depth; more: not "
                 "the same object");
    binder.field("confirm_hits", confirm_hits, {1, 100}, "a track seen less often ends with the first miss");
    binder.field("survive_misses_s", survive_misses_s, {0.0, 60.0}, "how long a confirmed track survives misses");
    binder.field("silence_s", silence_s, {0.0, 60.0}, "how long a track is carried without any detections");
    binder.field("unwatched_s", unwatched_s, {0.0, 60.0}, "without a detector for this long: geometry only");
  }
};

/// The life of tracks of movers without a class; docs/theory/dynamic_points.md section 4.
struct MoverTrackConfig {
  int confirm_hits = 3;
  double confirm_s = 0.13;
  double acceleration_m_s2 = 0.5;
  double expect_after_s = 1.0;
  double rest_s = 1.5;
  double gone_s = 0.5;
  double max_unseen_s = 5.0;
  double max_unseen_way_m = 0.5;

  void bind(auto& binder) {
    binder.field("confirm_hits", confirm_hits, {1, 100}, "a surface seen moving less often is not yet a mover");
    binder.field("confirm_s", confirm_s, {0.0, 10.0}, "... nor is one first seen moving less long ago");
    binder.field("acceleration_m_s2", acceleration_m_s2, {0.01, 100.0}, "of a mover without a class");
    binder.field("expect_after_s", expect_after_s, {0.0, 60.0},
                 "unseen for this long, it is masked where its track expects "
                 "it; before that memory does so");
    binder.field("rest_s", rest_s, {0.0, 60.0}, "seen at rest for this long, it has become part of the world");
    binder.field("gone_s", gone_s, {0.0, 60.0}, "its place seen without it for this long, it has gone");
    binder.field("max_unseen_s", max_unseen_s, {0.0, 60.0}, "not seen moving for longer, it may be anywhere");
    binder.field("max_unseen_way_m", max_unseen_way_m, {0.0, 10.0}, "the same for the way it may have gone meanwhile");
  }
};

}  // namespace rtd::filter
