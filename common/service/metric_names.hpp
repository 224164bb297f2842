// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

/// The names of the numbers in heartbeats (msg::Metric), each written once for those who set and those who read it. A
/// prefix ends with the character before the name of what the number is about.
namespace rtd::service::metric {

// Every service
inline constexpr char kHostId[] = "host_id";                        ///< the same number for all processes of a host
inline constexpr char kHostNamePrefix[] = "host_name.";             ///< and the name of the host
inline constexpr char kHung[] = "hung";                             ///< no progress of the worker, or an input is lost
inline constexpr char kBusProblems[] = "bus_problems";              ///< what the bus reported after joining
inline constexpr char kHeartbeatsRefused[] = "heartbeats_refused";  ///< of a name that another connection has
inline constexpr char kPeerPrefix[] = "peer.";                      ///< NAME.dead, NAME.hung
inline constexpr char kTopicPrefix[] = "topic.";                    ///< TOPIC.lost, TOPIC.rejected, ...
inline constexpr char kSentPrefix[] = "sent:";                      ///< and the topic: messages
inline constexpr char kClockPrefix[] = "clock.";                    ///< SERVICE, and one of the next three
inline constexpr char kClockReceivedSuffix[] = ".received_ms";
inline constexpr char kClockOffsetSuffix[] = ".offset_ms";
inline constexpr char kClockRoundTripSuffix[] = ".round_trip_ms";

// Several services
inline constexpr char kFrames[] = "frames";
inline constexpr char kFramesDropped[] = "frames_dropped";
inline constexpr char kFramesBroken[] = "frames_broken";
inline constexpr char kFramesDefective[] = "frames_defective";
inline constexpr char kBytes[] = "bytes";

// Camera
inline constexpr char kFramesIn[] = "frames_in";
inline constexpr char kFramesPublished[] = "frames_published";
inline constexpr char kFramesLate[] = "frames_late";
inline constexpr char kFramesSkipped[] = "frames_skipped";
inline constexpr char kFramesWithoutDepth[] = "frames_without_depth";
inline constexpr char kFramesOutOfRange[] = "frames_out_of_range";  ///< no depth is one that slam uses, or none at all
inline constexpr char kFramesLeftOut[] = "frames_left_out";         ///< the source had them, and could not give them
inline constexpr char kFrameIdPrefix[] = "frame_id.";               ///< and the name of the camera's frame
inline constexpr char kLeftOutPrefix[] = "left_out.";               ///< and the name of the reason
inline constexpr char kFramesRefused[] = "frames_refused";
inline constexpr char kReconnects[] = "reconnects";
inline constexpr char kJpegsDropped[] = "jpegs_dropped";
inline constexpr char kResends[] = "resends";
inline constexpr char kDepthOffsetMs[] = "depth_offset_ms";
inline constexpr char kDepthMedianM[] = "depth_median_m";
inline constexpr char kDepthHoles[] = "depth_holes";  ///< share of the pixels

// Detector
inline constexpr char kDetectMs[] = "detect_ms";
inline constexpr char kDetectMsMax[] = "detect_ms_max";
inline constexpr char kMasksMs[] = "masks_ms";  ///< mean time of the masks of a frame
inline constexpr char kMasks[] = "masks";       ///< persons that got one, of all frames
inline constexpr char kRateHz[] = "rate_hz";
inline constexpr char kLatencyP50Ms[] = "latency_p50_ms";
inline constexpr char kLatencyP99Ms[] = "latency_p99_ms";
inline constexpr char kBatchMean[] = "batch_mean";
inline constexpr char kRobots[] = "robots";
inline constexpr char kRobotsServed[] = "robots_served";
inline constexpr char kRobotsRead[] = "robots_read";

// Filter
inline constexpr char kModePrefix[] = "mode.";  ///< and the name of the mode (common/msg/filter_modes.hpp)
/// The mean time of each stage, in the order of msg::FilterStage.
inline constexpr std::array kFilterStageMs = {"wait_ms",        "extract_ms", "masks_ms", "ego_motion_ms",
                                              "depth_check_ms", "fuse_ms",    "filter_ms"};
inline constexpr char kLoadStep[] = "load_step";  ///< 0 = everything as configured, else an index of kLoadSteps
inline constexpr char kFramesFromOthers[] = "frames_from_others";
inline constexpr char kFramesWithoutDetections[] = "frames_without_detections";
inline constexpr char kFeatures[] = "features";
inline constexpr char kFeaturesRemoved[] = "features_removed";
inline constexpr char kObjects[] = "objects";
inline constexpr char kDynamicClusters[] = "dynamic_clusters";

// Slam
inline constexpr char kFramesTracked[] = "frames_tracked";
inline constexpr char kFramesDoubtful[] = "frames_doubtful";
inline constexpr char kFramesPredicted[] = "frames_predicted";
inline constexpr char kAgreement[] = "agreement";       ///< of what is recognised with the pose, 0 to 1
inline constexpr char kViewRemoved[] = "view_removed";  ///< share of the features removed as moving
inline constexpr char kSinceOkS[] = "since_ok_s";       ///< since the last frame in state ok
inline constexpr char kPositionSigmaM[] = "position_sigma_m";
inline constexpr char kRotationSigmaDeg[] = "rotation_sigma_deg";
inline constexpr char kFeaturesInvalid[] = "features_invalid";
inline constexpr char kKeyframes[] = "keyframes";
inline constexpr char kLandmarks[] = "landmarks";
inline constexpr char kLoopsClosed[] = "loops_closed";
inline constexpr char kLocalizeOnly[] = "localize_only";
inline constexpr char kMapZUp[] = "map_z_up";
inline constexpr char kReadoutMs[] = "readout_ms";
inline constexpr char kSlamMs[] = "slam_ms";
inline constexpr char kImuSamples[] = "imu_samples";
inline constexpr char kImuDropped[] = "imu_dropped";
inline constexpr char kImuGaps[] = "imu_gaps";
inline constexpr char kImuClockJumps[] = "imu_clock_jumps";
inline constexpr char kImuReady[] = "imu_ready";
inline constexpr char kWheelSamples[] = "wheel_samples";
inline constexpr char kWheelDropped[] = "wheel_dropped";
inline constexpr char kWheelJumps[] = "wheel_jumps";

// Dense
inline constexpr char kFramesWithoutImage[] = "frames_without_image";
inline constexpr char kFramesWithoutMask[] = "frames_without_mask";
inline constexpr char kFramesNotTracked[] = "frames_not_tracked";
inline constexpr char kVoxels[] = "voxels";
inline constexpr char kVoxelsCarved[] = "voxels_carved";
inline constexpr char kPointsWithoutRoom[] = "points_without_room";

// Record
inline constexpr char kRecording[] = "recording";  ///< 1 while a recording runs
inline constexpr char kMessages[] = "messages";
inline constexpr char kLostInTransit[] = "lost_in_transit";
inline constexpr char kLostInQueue[] = "lost_in_queue";
inline constexpr char kQueueBytes[] = "queue_bytes";
inline constexpr char kAcknowledged[] = "acknowledged";
inline constexpr char kAcknowledgedBytes[] = "acknowledged_bytes";
inline constexpr char kAcknowledgedPrefix[] = "acknowledged:";  ///< and the topic

// Replay
inline constexpr char kRunTopics[] = "run_topics";  ///< how many of its topics a run would follow
inline constexpr char kMessagesSent[] = "messages_sent";
inline constexpr char kReplayBeginS[] = "replay.begin_s";
inline constexpr char kReplayAtS[] = "replay.at_s";
inline constexpr char kReplayPositionS[] = "replay.position_s";
inline constexpr char kReplayLengthS[] = "replay.length_s";
inline constexpr char kReplaySpeed[] = "replay.speed";
inline constexpr char kReplayPaused[] = "replay.paused";

// Link
inline constexpr char kOutPrefix[] = "out:";  ///< and the topic
inline constexpr char kInPrefix[] = "in:";    ///< and the topic
inline constexpr char kLost[] = "lost";

// Atlas
inline constexpr char kRobotsMet[] = "robots_met";              ///< robots that are in the joint map
inline constexpr char kMeetings[] = "meetings";                 ///< of robots, confirmed
inline constexpr char kMeetingsRefused[] = "meetings_refused";  ///< of these, taken back: they bent the map of another
inline constexpr char kCorrections[] = "corrections";           ///< of the joint map
inline constexpr char kAskedWhere[] = "asked_where";            ///< frames of robots that asked for their place
inline constexpr char kLocated[] = "located";                   ///< of these, found

// Viewer
inline constexpr char kClients[] = "clients";
inline constexpr char kClientsReady[] = "clients_ready";  ///< that show what comes: a page needs seconds to load
inline constexpr char kClientsTooSlow[] = "clients_too_slow";
inline constexpr char kSentMb[] = "sent_mb";
inline constexpr char kRequests[] = "requests";
inline constexpr char kRequestsRefused[] = "requests_refused";
inline constexpr char kMapItemsLeftOut[] = "map_items_left_out";
inline constexpr char kMessagesDropped[] = "messages_dropped";

}  // namespace rtd::service::metric
