// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/process/process_host.hpp"

namespace rtd::launcher {

/// What the death of a service means for the run.
enum class ServiceRole {
  kSource,     ///< what is stored: its end is the end of the run. One that crashes or hangs is restarted if the plan
               ///< says how it continues; one that gives up is not, for it would do so again
  kLive,       ///< a camera: restarted, because it continues where it is now; its clean end is the end of the run
  kEssential,  ///< restarted; when it keeps dying the run fails
  kOptional,   ///< restarted; when it keeps dying the run continues without it (detector)
};

/// One service of a run.
struct ServicePlan {
  std::string name;
  std::vector<std::string> command;  ///< executable and arguments
  ServiceRole role = ServiceRole::kEssential;
  int niceness = 0;        ///< see ProcessSpec
  bool ends_last = false;  ///< stopped after all others: a recorder still receives their last messages
  /// More arguments for a restart; may be empty. Called at each restart.
  std::function<std::vector<std::string>()> when_restarted = {};
  /// Of a live camera: whether it has ever given a frame. One that gave up before is not started again, because it has
  /// waited long enough; empty: it is.
  std::function<bool()> has_served = {};
  bool outlives_run = false;  ///< not stopped with a run that ended by itself, but by end_rest()
  bool awaited = false;       ///< the source sends nothing before this one is ready
};

struct SupervisorOptions {
  int max_restarts = 5;        ///< deaths in a row before a service is given up
  int first_backoff_ms = 200;  ///< pause before the restart of one that died young, doubled
  /// Without a sign of life after the first: killed. Ten times as long for one that gets no processor; 0 = never.
  int hung_after_ms = 3000;
};

enum class RunOutcome {
  kRunning,      ///< not decided yet
  kComplete,     ///< the source ended by itself
  kFailed,       ///< the source or an essential service failed for good
  kConfigError,  ///< a service refused its arguments or configuration (exit code 2 or 4 at its first start)
  kInterrupted,  ///< stopped by the user
};

/// Something to report to the user.
struct SupervisorEvent {
  enum class Kind { kStarted, kDied, kRestarted, kGivenUp, kRefused, kEnded, kKilled };
  Kind kind;
  std::string service;
  std::string text;  ///< one line, names service and reason
  process::ProcessId process = 0;
  process::ProcessExit exit{};  ///< kDied, kGivenUp, kRefused, kEnded, kKilled
  std::string how = {};  ///< kDied, kGivenUp: "died: killed by signal 9 (SIGKILL)", "hung for 3 s and was killed"
};

/// Keeps the services of one run alive: restarts what dies, kills what hangs, decides when the run is over, ends
/// everything in bounded time. Time comes in as an argument (any monotonic clock). Not thread-safe.
class Supervisor {
 public:
  using Clock = std::chrono::milliseconds;

  Supervisor(process::ProcessHost& host, SupervisorOptions options,
             std::function<void(const SupervisorEvent&)> on_event);

  /// Starts a service. Throws ProcessError when its executable cannot be run.
  void start(const ServicePlan& plan, Clock now);
  /// Looks for deaths, restarts services when due, kills those that hang or outlive the grace of stop(). Call it often:
  /// when it was not called for a second, the launcher itself stood still, and all services have that time on top.
  void update(Clock now);
  /// Asks every service to end, those with ends_last after the others; update() kills those still there `grace` after
  /// they were asked. The first outcome stays. A second stop asks all at once. Those that outlive the run go on, unless
  /// it was interrupted or refused.
  void stop(Clock now, Clock grace, RunOutcome why);

  RunOutcome outcome() const { return outcome_; }
  bool stopping() const { return stopping_; }
  /// Asks those that outlive the run to end.
  void end_rest(Clock now, Clock grace);
  /// No process of the run is left; those that outlive it may be.
  bool all_ended() const;
  /// One that outlives the run is there.
  bool rest_runs() const;
  /// It runs or is about to be restarted.
  bool runs(const std::string& service) const;
  /// Name and id of every process that runs now.
  std::vector<std::pair<std::string, process::ProcessId>> running() const;

 private:
  enum class State { kRunning, kWaiting, kEnded };
  struct Child {
    ServicePlan plan;
    process::ProcessId process = 0;
    State state = State::kEnded;
    int deaths_in_row = 0, restarts = 0;
    Clock started{}, restart_at{};
    bool asked = false, killed = false;
    bool work_done = false;  ///< it has said that it ends
    Clock kill_at{};
    std::uint64_t signs_of_life = 0;
    Clock last_sign{};
    std::optional<Clock> waited;  ///< for a processor, when it had been silent for half of hung_after
  };

  void launch(Child& child, Clock now, const std::vector<std::string>& more_arguments = {});
  void relaunch(Child& child, Clock now);
  void on_exit(Child& child, const process::ProcessExit& exit, Clock now);
  void on_death(Child& child, const process::ProcessExit& exit, Clock now);
  void watch(Child& child, Clock now);
  bool hangs(Child& child, Clock now);
  void exclude_standstill(Clock now);
  void ask_to_end(Child& child, Clock kill_at);
  bool continues(const Child& child) const { return child.plan.outlives_run && !rest_ends_; }
  bool others_ended() const;
  void decide(RunOutcome outcome);
  void report(SupervisorEvent::Kind kind, const Child& child, const std::string& text,
              const process::ProcessExit& exit = {}, const std::string& how = {});

  process::ProcessHost& host_;
  SupervisorOptions options_;
  std::function<void(const SupervisorEvent&)> on_event_;
  std::vector<Child> children_;
  RunOutcome outcome_ = RunOutcome::kRunning;
  bool stopping_ = false, rest_ends_ = false;
  Clock grace_{}, updated_{};
};

}  // namespace rtd::launcher
