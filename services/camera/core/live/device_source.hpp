// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/device_uri.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/recording/frame_pairer.hpp"
#include "common/vision/depth_registration.hpp"
#include "services/camera/core/live/live_device.hpp"

namespace rtd::camera {

/// Puts the stamps of a device, whose clock may begin anywhere and jump, on the host's clock: differences of stamps
/// stay those of the device, and no stamp is older than one before, over restarts of the device too. All times in ns.
class DeviceTimeline {
 public:
  /// The next image begins the device's time again.
  void restart() { offset_ns_.reset(); }

  /// Takes note of an image that came at now_ns. Returns by how much the device's clock has jumped, 0 = not at all. An
  /// image that is late (a program that was stopped, a full bus) is no jump; an image from the future or more than
  /// kJumpNs older than the one before is.
  std::int64_t note(std::int64_t stamp_ns, std::int64_t now_ns) {
    const bool begins = !offset_ns_;
    const std::int64_t early_ns = begins ? 0 : host_ns(stamp_ns) - now_ns;
    const bool back = !begins && stamp_ns < newest_ns_ - kJumpNs;
    const std::int64_t jump_ns = back ? stamp_ns - newest_ns_ : early_ns > kJumpNs ? early_ns : 0;
    if (begins || jump_ns != 0) offset_ns_ = std::max(now_ns, newest_host_ns_ + kStepNs) - stamp_ns;
    if (!begins && jump_ns == 0 && early_ns > 0) *offset_ns_ -= std::min(early_ns, kSlideNs);
    newest_ns_ = stamp_ns;
    newest_host_ns_ = std::max(newest_host_ns_, host_ns(stamp_ns));
    return jump_ns;
  }

  /// The host's time of a stamp; after the first note().
  std::int64_t host_ns(std::int64_t stamp_ns) const { return stamp_ns + *offset_ns_; }

 private:
  static constexpr std::int64_t kJumpNs = 500'000'000;
  static constexpr std::int64_t kStepNs = 1'000'000;
  /// No image comes before it was made: a clock that runs fast is followed, by 1000 ppm at 30 Hz at most.
  static constexpr std::int64_t kSlideNs = 33'000;

  std::optional<std::int64_t> offset_ns_;
  std::int64_t newest_ns_ = 0, newest_host_ns_ = std::numeric_limits<std::int64_t>::min() / 2;
};

/// Watches what a device delivers for faults that leave it running: an image that stands still, depth without
/// measurements, frames that are lost. Times are the host's, ns. Not thread-safe.
class DeviceHealth {
 public:
  /// The device starts now, at a nominal rate in Hz.
  void restart(std::int64_t now_ns, double fps);
  void note_color(std::int64_t now_ns, const std::vector<std::uint8_t>& bytes);
  void note_frame(std::int64_t now_ns, bool has_depth);

  /// The same bytes for a second. Noise changes every image of a sensor, in the dark too.
  bool frozen(std::int64_t now_ns) const;
  /// What is wrong with the frames that come, with likely causes; empty when nothing is.
  std::string fault(std::int64_t now_ns) const;

 private:
  std::string lost_frames(std::int64_t now_ns) const;

  double fps_ = 0;
  std::int64_t started_ns_ = 0, color_changed_ns_ = 0, depth_seen_ns_ = 0;
  std::optional<std::size_t> color_hash_;
  std::deque<std::int64_t> frames_ns_;  ///< of the last two seconds
};

struct DeviceOptions {
  DeviceUri uri;
  std::int64_t open_timeout_ns = 30'000'000'000;  ///< until the first frame
  /// Added to the clock's time in the stamps: makes them Unix time.
  std::int64_t epoch_ns = 0;
  /// Receives what is wrong or waited for, about once a second, and an empty text when all is well (again).
  std::function<void(const std::string&)> on_wait = [](const std::string&) {};
};

/// Frames of a device on this host or network: colour and depth paired by the device's stamps, which are put on the
/// host's clock; depth of a camera of its own is registered to colour. A device that is unplugged, silent or without
/// pairs is closed and opened again, with a back-off, until the source is stopped; its frames continue with the same
/// calibration. A recording is played once, with its own stamps; so are, as they come, the images of a camera that
/// another program runs.
class DeviceSource final : public FrameSource {
 public:
  DeviceSource(std::unique_ptr<LiveDevice> device, std::unique_ptr<DeviceClock> clock, DeviceOptions options);
  ~DeviceSource() override;

  /// Waits for a first frame; only that of a recording is given out, a camera's is old by then. Throws SourceError:
  /// nothing comes in time; busy, no permission, no such mode, encoding, sizes, no calibration.
  bool open() override;
  std::optional<SourceFrame> next() override;
  std::uint64_t pass_over(std::int64_t) override { return 0; }
  const SourceInfo& info() const override { return info_; }
  const SourceCounters& counters() const override { return skips_.counters(); }
  geometry::Trajectory groundtruth() const override { return {}; }
  std::vector<SkippedInput> take_skipped() override { return skips_.take(); }
  void stop() override { clock_->close(); }

 private:
  /// What has come of a stream since the device was started.
  struct Images {
    bool any = false;
    std::int64_t stamp_ns = 0, arrived_ns = 0;  ///< of the newest
  };

  /// One step: starts the device or reads an image; empty when there is no frame yet.
  std::optional<SourceFrame> step();
  void try_to_start();
  void start();
  void use(const DeviceSetup& setup);
  void calibrate(const DeviceSetup& setup);
  /// Takes over calibration and depth camera.
  void adopt(const DeviceSetup& setup);
  std::optional<SourceFrame> read();
  void take(DeviceImage image);
  void follow_clock(std::int64_t stamp_ns, std::int64_t now_ns);
  std::optional<SourceFrame> make_frame(const FramePairer::Pair& pair);
  /// Takes over the setup that the first images give; false while something lacks.
  bool settle(const FramePairer::Pair& first);
  /// Whether the device is watched, started again, and its stamps put on the host's clock.
  bool managed() const { return info_.live && !run_by_others_; }
  void restart_if_silent();
  /// Closes the device; the next step() opens it again after the back-off.
  void lose(const DeviceError& error);
  void back_off();
  /// Reports a fault when it is new and about once a second, and its end.
  void report(const std::string& what);
  void report_now(const std::string& what);
  std::string cause() const;
  std::string silence() const;
  Arrivals arrivals(const Images& images) const;
  void forget_pairs();
  /// Drops what waits in the device: it is old by now.
  void drop_waiting();

  const DeviceOptions options_;
  const std::unique_ptr<LiveDevice> device_;
  const std::unique_ptr<DeviceClock> clock_;
  SourceInfo info_;
  std::optional<vision::DepthRegistration> registration_;
  SkipLog skips_;
  std::optional<FramePairer> pairer_;
  DeviceTimeline timeline_;
  DeviceHealth health_;
  DeviceSetup setup_;
  Images color_, depth_;
  bool known_ = false;          ///< a frame was made: from now on sizes and calibration stay
  bool run_by_others_ = false;  ///< by another program
  bool running_ = false, opened_ = false, ended_ = false, reported_fault_ = false;
  std::optional<SourceFrame> first_;  ///< of open()
  std::string problem_;               ///< why it does not run
  std::chrono::milliseconds back_off_;
  std::int64_t started_ns_ = 0, last_pair_ns_ = 0, reported_ns_ = 0;
};

}  // namespace rtd::camera
