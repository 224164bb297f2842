// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/process/posix_process_host.hpp"
#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"
#include "services/launcher/core/run/supervisor.hpp"
#include "services/launcher/core/run/terminal.hpp"
#include "services/launcher/process/frame_file.hpp"
#include "services/launcher/process/service_logs.hpp"
#include "services/launcher/process/usage_registry.hpp"
#include "services/launcher/run/collector.hpp"
#include "services/launcher/run/run_setup.hpp"

namespace rtd::launcher {

/// One run from the first process to the last: starts, supervises and ends the services, and records the run.
class RunSession {
 public:
  RunSession(const RunSetup& setup, bus::Bus& bus, service::InterruptSignals& signals, Terminal& terminal);

  /// Returns when no process is left. Throws ProcessError when a service cannot be started at all,
  /// service::ConfigError when another run is in the same DDS domain.
  RunOutcome run(const std::vector<ServicePlan>& plans);
  /// After run(): the viewer that outlives it stays until it is asked to end.
  void keep_viewer();
  /// Asks it to end now, and waits for that.
  void end_viewer();
  /// What was observed; call it after run().
  run_record::RunRecord record() const;
  /// At the end the first piece that the source left out; may be empty.
  std::string camera_message() const { return collector_.ask(&RecordBuilder::camera_message); }
  bool tracked_any() const { return collector_.ask(&RecordBuilder::tracked_any); }
  /// Slam was restarted, each time with the map of a checkpoint: its poses before and after are in one world.
  bool slam_kept_its_world() const { return slam_restarts_ > 0 && slam_worlds_lost_ == 0; }
  bool slam_lost_its_world() const { return slam_worlds_lost_ > 0; }

 private:
  using Milliseconds = std::chrono::milliseconds;

  void require_free_domain();
  void require_none_active(const Tolerated& tolerated) const;
  void supervise(const ServicePlan& source);
  bool misses_no_result(Milliseconds now) const;
  bool waits_for_page(const ServicePlan& source);
  void on_event(const SupervisorEvent& event);
  void explain(const std::string& service, const std::vector<std::string>& lines);
  std::chrono::milliseconds interrupt_grace() const;
  void stop_when_decided(Milliseconds now);
  void sample_memory(Milliseconds now);
  void wait_for_viewer(Milliseconds grace);
  void note(const std::string& text);
  ServicePlan counted(ServicePlan plan);
  std::vector<std::string> continue_camera() const;

  const RunSetup& setup_;
  service::InterruptSignals& signals_;
  Terminal& terminal_;
  ServiceLogs logs_;
  UsageRegistry usage_;
  FrameFile frames_;
  Collector collector_;
  process::PosixProcessHost host_;
  Supervisor supervisor_;
  std::vector<std::string> events_;
  Milliseconds started_{}, next_sample_{};
  double own_cpu_before_s_ = 0;
  std::vector<std::string> awaited_;  ///< services that the source waits for
  std::string viewer_line_;           ///< its addresses, as it printed them
  bool page_was_open_ = false, wait_shown_ = false;
  int slam_restarts_ = 0, slam_worlds_lost_ = 0;
};

}  // namespace rtd::launcher
