// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/camera/live_uri.hpp"
#include "common/camera/recording/frame_pairer.hpp"
#include "common/vision/depth_registration.hpp"
#include "services/camera/core/live/device_health.hpp"
#include "services/camera/core/live/live_device.hpp"

namespace rtd::camera {

struct DeviceOptions {
  DeviceUri uri;
  std::int64_t open_timeout_ns = 30'000'000'000;  ///< until the first frame
  /// Added to the clock's time in the stamps: makes them Unix time.
  std::int64_t epoch_ns = 0;
  /// Receives what is wrong or waited for, about once a second, and an empty text when all is well (again).
  std::function<void(const std::string&)> on_wait = [](const std::string&) {};
};

/// Frames of a device on this host or network: colour and depth paired by the device's stamps, which are put on the
/// host's clock; depth of its own camera is registered to colour. A device that is unplugged, silent or without
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
  void begin_again(const std::string& why);
  void start();
  void use(const DeviceSetup& setup);
  void calibrate(const DeviceSetup& setup);
  /// Takes over calibration and depth camera.
  void adopt(const DeviceSetup& setup);
  std::optional<SourceFrame> read();
  void take(DeviceImage image);
  void follow_clock(std::int64_t stamp_ns, std::int64_t now_ns);
  std::optional<SourceFrame> make_frame(const FramePairer::Pair& pair);
  /// Throws DeviceError, kChanged, when the images of another program stay so.
  void note_other_size(cv::Size color_px, cv::Size depth_px);
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
  bool known_ = false;          ///< a frame was made: from now on sizes and calibration stay (begin_again())
  bool run_by_others_ = false;  ///< by another program
  bool running_ = false, opened_ = false, ended_ = false, reported_fault_ = false;
  std::optional<SourceFrame> first_;  ///< of open()
  std::string problem_;               ///< why it does not run
  std::chrono::milliseconds back_off_;
  std::int64_t started_ns_ = 0, last_pair_ns_ = 0, last_frame_ns_ = 0, reported_ns_ = 0;
  int other_sizes_ = 0;  ///< pairs in a row that do not have the size of the camera
};

}  // namespace rtd::camera
