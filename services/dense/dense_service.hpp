// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/service/exit_code.hpp"
#include "common/service/log.hpp"
#include "common/service/runtime.hpp"
#include "services/dense/config.hpp"
#include "services/dense/core/background.hpp"
#include "services/dense/core/static_map.hpp"
#include "services/dense/frame_joiner.hpp"

namespace CLI {
class App;
}

namespace rtd::dense {

/// Images, the filter's masks and slam's poses in, a dense static cloud out. No other service ever waits for
/// it; frames that it has no time for are counted. Writes static_map.ply (and background.png) when it is asked to stop.
class DenseService {
 public:
  static constexpr const char* kName = "dense";
  static constexpr const char* kDescription = "Fuses depth images without what moves into a dense static map";
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, Config& config);

  DenseService(const Config& config, service::Runtime& runtime);
  DenseService(const DenseService&) = delete;
  DenseService& operator=(const DenseService&) = delete;
  service::ExitCode run();

 private:
  void take_mask(const msg::Image& message);
  void integrate(const JoinedFrame& joined);
  void update(const std::vector<KeyframeUpdate>& updates);
  void count(const FusionReport& report);
  void publish_cloud();
  void finish();
  bool ready();
  std::string trouble();
  void report_state();
  service::ExitCode write_files();
  bool write_cloud(const std::string& path);
  bool write_background(const std::string& path);

  const Config config_;
  service::Runtime& runtime_;
  StaticMap map_;
  BackgroundPainter background_;
  std::shared_ptr<FrameJoiner> joiner_;
  bus::Writer<msg::PointCloud2> cloud_writer_;
  bus::Reader<msg::KeyframeEvent> keyframe_reader_;
  bus::Reader<msg::TrackingResult> tracking_reader_;
  bus::Reader<msg::Image> mask_reader_;
  bus::Reader<msg::RgbdFrame> frame_reader_;

  struct Totals {
    std::uint64_t frames = 0, defective = 0, points = 0, masked = 0, refused = 0, carved = 0;
  } totals_;
  std::int64_t newest_stamp_ns_ = 0, published_ns_ = 0, updated_ns_ = 0;
  bool full_logged_ = false;
  service::RateLimit defect_log_{std::chrono::seconds(1)}, mask_log_{std::chrono::seconds(5)};
};

}  // namespace rtd::dense
