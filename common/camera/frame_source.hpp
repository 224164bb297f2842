// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/geometry/trajectory.hpp"
#include "common/io/byte_sink.hpp"
#include "common/vision/rgbd_image.hpp"

namespace rtd::camera {

/// A source cannot be used at all; what() names file, line or parameter, the value and the fix.
class SourceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Why a piece of the input was left out. The source continues with the next one.
enum class SkipReason {
  kMalformedLine,    ///< a list line that does not read as "stamp file"
  kNoDepthPartner,   ///< no depth image within the pairing tolerance
  kStampBackwards,   ///< older than the frame before
  kStampDoubled,     ///< same stamp as the frame before
  kColorUnreadable,  ///< missing, truncated or not an image
  kDepthUnreadable,  ///< missing, truncated or not an image
  kDepthNot16Bit,    ///< 8-bit, float or several channels
  kSizeMismatch,     ///< colour, depth and calibration do not have one size
  kDamagedRecord,    ///< a piece of a recording that cannot be read
  kOverrun,          ///< running camera: the message came before earlier ones were processed
  kColorFrozen,      ///< running camera: the colour image has not changed for a second
  kRepeated,         ///< the frame before once more, the same bytes with the same stamp: nothing is lost
  kOtherCamera,      ///< of another camera that sends on the same topic
  kEmitterDots,      ///< infrared with the dots of an emitter that is switched on and off in turn
};
inline constexpr std::size_t kSkipReasons = 14;

/// "color_unreadable": for counters and logs.
const char* to_string(SkipReason reason);
/// What is wrong with such frames and what helps: "their stamps are older than ...: give each frame its time".
const char* explain(SkipReason reason);
/// The reason of that name; empty for another text.
std::optional<SkipReason> skip_reason_of(std::string_view name);
/// Whether nothing is lost by what is left out for it: repeats, images between those that are used.
bool is_intended(SkipReason reason);

/// One piece of input that was left out, with a line for people that names file and cause.
struct SkippedInput {
  SkipReason reason;
  std::string detail;
};

/// What a source has done so far.
struct SourceCounters {
  std::uint64_t frames = 0;                           ///< handed out or passed over
  std::array<std::uint64_t, kSkipReasons> skipped{};  ///< by SkipReason
  std::uint64_t frames_without_depth = 0;             ///< handed out although no pixel has a measurement
  std::uint64_t reconnects = 0;                       ///< running camera: it was opened again
  std::uint64_t depth_alone = 0;                      ///< depth images that no colour image was found for
  std::uint64_t skipped_total() const;
  /// Frames that the source had and did not hand out. Colour images without depth count as far as depth images were
  /// left over: where depth comes at half the rate of colour, every second colour image is none. What is_intended()
  /// does not count.
  std::uint64_t frames_left_out() const;
  std::uint64_t of(SkipReason reason) const { return skipped[static_cast<std::size_t>(reason)]; }
};

/// An object that a source knows to be in the image: the truth that a detector is measured against.
struct SourceObject {
  int id = 0;              ///< the same in every frame of a source
  std::string class_name;  ///< COCO name, or "box": no class of a detector
  cv::Rect box_px;         ///< around its visible pixels
  int visible_px = 0;
  bool moving = false;  ///< now, wholly or in part
};

/// What an IMU measured, in the camera's optical frame.
struct ImuReading {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d gyro_rad_s = Eigen::Vector3d::Zero(), accel_m_s2 = Eigen::Vector3d::Zero();
};

/// What the wheels of the base say: pose since the start, and speed in the axes of the base.
struct WheelReading {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_odom_base = Eigen::Isometry3d::Identity();
  Eigen::Vector3d linear_m_s = Eigen::Vector3d::Zero(), angular_rad_s = Eigen::Vector3d::Zero();
};

/// One frame of a source.
struct SourceFrame {
  vision::RgbdImage image;  ///< seq counts from 0 without gaps; depth 0 = no measurement
  cv::Mat dynamic_mask;     ///< CV_8UC1, 255 = moving object; empty when the source has none
  std::optional<Eigen::Isometry3d>
      T_world_camera;                 ///< exact pose of synthetic sources; with ReadAhead also true_pose()
  std::vector<SourceObject> objects;  ///< all that are seen, synthetic sources only
  bool has_depth = true;              ///< some pixel has a measurement
  /// Stamp of the depth image minus that of the colour image; empty where both have one stamp.
  std::optional<std::int64_t> depth_after_color_ns = {};
  std::vector<ImuReading> imu = {};       ///< since the frame before, up to the first one that is not before this frame
  std::vector<WheelReading> wheels = {};  ///< the same
};

/// What is known about a source before its first frame.
struct SourceInfo {
  std::string uri;
  geometry::CameraModel camera;
  double depth_scale_m = 0;  ///< metres of one depth unit
  double fps = 30;           ///< nominal rate, Hz
  std::uint64_t frames = 0;  ///< frames expected (an upper bound: broken ones are skipped); 0 = endless
  bool live = false;         ///< a running camera: frames come when they come, camera and unit are known after open()
  double readout_s = 0;      ///< of the colour image's rolling shutter, first row to last, s; 0 = none or unknown
  /// What the device adds to the difference of the stamps of depth and colour, s; 0 = nothing or unknown.
  double depth_offset_s = 0;
  /// The depth unit was given: a calibration, a parameter, a standard. Otherwise it is the usual one.
  bool depth_unit_given = true;
  std::vector<std::string> notes = {};       ///< what the source was taken for, for people
  std::vector<std::string> remarks = {};     ///< what is wrong with it although it is played: a ground truth not used
  bool has_imu = false, has_wheels = false;  ///< frames come with what they measured
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();  ///< of the wheels' base; of synthetic sources
  std::string frame_id = {};  ///< of the colour images, as their driver names it; empty: it does not
};

/// A sequence of RGB-D frames. Errors at opening throw SourceError; single bad frames are skipped and counted.
/// Not thread-safe.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Waits until frames come; false when it was stopped before. What is played from a file is open from the start.
  virtual bool open() { return true; }
  /// Thread-safe: a running camera gives no more frames, open() and next() return.
  virtual void stop() {}
  /// The next good frame; empty at the end.
  virtual std::optional<SourceFrame> next() = 0;
  /// Passes over the frames older than `stamp_ns` without the work of making them; they keep their seq. Returns how
  /// many.
  virtual std::uint64_t pass_over(std::int64_t stamp_ns) = 0;
  virtual const SourceInfo& info() const = 0;
  virtual const SourceCounters& counters() const = 0;
  /// Ground truth of the span covered: poses of the camera in a world frame of the source's own; empty when there is
  /// none. Endless sources give the part played so far.
  virtual geometry::Trajectory groundtruth() const = 0;
  /// The true pose of the camera at a stamp of the part played so far, in the same world; empty when it is not known
  /// nearer than kTrueWithinNs. Synthetic sources give it with the frame.
  virtual std::optional<Eigen::Isometry3d> true_pose(std::int64_t /*stamp_ns*/) const { return std::nullopt; }
  /// What was skipped since the last call, for the log.
  virtual std::vector<SkippedInput> take_skipped() = 0;
};

inline constexpr const char* kOutsideAdvice = "add ?outside=1 to the source to use it all the same";
/// Why a file of a folder cannot be read, for people: with that advice where it leads out of the folder.
std::string why_unread(const io::IoError& error);

/// Counts the skipped inputs of a source and keeps their log lines until take().
class SkipLog {
 public:
  void add(SkippedInput input);
  /// Gives a frame that is handed out its number and counts it.
  void number(SourceFrame& frame);
  SourceCounters& counters() { return counters_; }
  const SourceCounters& counters() const { return counters_; }
  std::vector<SkippedInput> take() { return std::exchange(skipped_, {}); }
  /// ": 2 x size_mismatch, first: ..."; empty when nothing was left out.
  std::string summary() const;
  /// What has left out all images since the last frame: how many, and the newest. Empty when nothing was left out for
  /// what it is (that colour and depth do not pair, or came too fast, has its own words).
  std::string why_none() const;

 private:
  SourceCounters counters_;
  std::vector<SkippedInput> skipped_;
  std::uint64_t unusable_ = 0;  ///< since the last frame
  std::string newest_;          ///< of these
};

/// A source that plays a file: what its frames are made of is left to the derived class.
class PlayedSource : public FrameSource {
 public:
  std::optional<SourceFrame> next() final;
  std::uint64_t pass_over(std::int64_t stamp_ns) final;
  const SourceInfo& info() const final { return info_; }
  const SourceCounters& counters() const final { return skips_.counters(); }
  std::vector<SkippedInput> take_skipped() final { return skips_.take(); }

 protected:
  /// Goes to the next frame and gives its stamp; empty at the end.
  virtual std::optional<std::int64_t> advance() = 0;
  /// Decodes the frame gone to; empty when it cannot be used.
  virtual std::optional<SourceFrame> decode() = 0;
  /// Whether there is anything to decode, without the work of it: what is passed over counts as a frame if there is.
  virtual bool is_there() const { return true; }
  /// Ends opening. Throws SourceError naming the file when it has no good frame.
  void read_first(const std::string& file);

  SourceInfo info_;
  SkipLog skips_;

 private:
  std::optional<SourceFrame> read_next();

  std::optional<std::int64_t> gone_to_;  ///< stamp of the current frame, not decoded yet
  std::optional<SourceFrame> first_;     ///< read while opening
};

/// TUM's tolerance for pairing colour and depth stamps; the default of `tolerance_ms`.
inline constexpr std::int64_t kPairingToleranceNs = 20'000'000;

/// Ground truth is given this far beyond the first and last frame, so that an evaluator can interpolate.
inline constexpr std::int64_t kGroundtruthMarginNs = 500'000'000;

/// A moment has a true pose when one is known so near before and after it: some clips have one for each frame only.
inline constexpr std::int64_t kTrueWithinNs = 50'000'000;

/// Why colour, depth and calibration do not make a frame; empty when they do. `name` is the colour image's, `more` what
/// the source needs besides other ?intrinsics=.
std::optional<SkippedInput> size_mismatch(const std::string& name, const cv::Mat& color, const cv::Mat& depth,
                                          const geometry::CameraModel& camera, const std::string& more = {});

/// The frame that a pair of images of one stamp makes; seq is given when it is handed out.
SourceFrame to_frame(std::int64_t stamp_ns, cv::Mat color_bgr, cv::Mat depth, const SourceInfo& info);

/// For a depth image with its own stamp: the frame's depth_offset_s is the difference of the stamps and what the
/// device adds; 0 = unknown when that is more than a frame may say.
void set_depth_stamp(SourceFrame& frame, std::int64_t depth_ns, const SourceInfo& info);

/// The poses between these stamps and kGroundtruthMarginNs around them.
geometry::Trajectory poses_of_span(geometry::Trajectory poses, std::int64_t from_ns, std::int64_t to_ns);

/// "640 x 480".
std::string size_text(cv::Size size_px);

}  // namespace rtd::camera
