// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/supervisor.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

namespace rtd::launcher {
namespace {

constexpr int kExitUsageOrConfig = 2, kExitAlreadyRuns = 4;
constexpr int kMostPatience = 10;               // times as long for one that gets no processor
constexpr Supervisor::Clock kStoodStill{1000};  // update() is called many times in it
constexpr Supervisor::Clock kMostBackoff{2000};
constexpr Supervisor::Clock kHealthyAfter{5000};  // a service that lived this long starts a new row, at once

/// "1st", "2nd", "3rd", "4th", ..., "11th".
std::string ordinal(int number) {
  const int last = number % 100 / 10 == 1 ? 0 : number % 10;
  const char* ending = last == 1 ? "st" : last == 2 ? "nd" : last == 3 ? "rd" : "th";
  return std::to_string(number) + ending;
}

Supervisor::Clock backoff(const SupervisorOptions& options, int deaths_in_row) {
  Supervisor::Clock pause(options.first_backoff_ms);
  for (int i = 1; i < deaths_in_row && pause < kMostBackoff; ++i) pause *= 2;
  return std::min(pause, kMostBackoff);
}

}  // namespace

Supervisor::Supervisor(process::ProcessHost& host, SupervisorOptions options,
                       std::function<void(const SupervisorEvent&)> on_event)
    : host_(host), options_(options), on_event_(std::move(on_event)) {}

void Supervisor::start(const ServicePlan& plan, Clock now) {
  Child child;
  child.plan = plan;
  launch(child, now);
  report(SupervisorEvent::Kind::kStarted, child, plan.name + " started");
  children_.push_back(std::move(child));
}

void Supervisor::update(Clock now) {
  exclude_standstill(now);
  for (Child& child : children_) {
    if (child.state == State::kRunning) {
      if (const auto exit = host_.poll_exit(child.process)) on_exit(child, *exit, now);
    }
    if (child.state == State::kWaiting && now >= child.restart_at) relaunch(child, now);
    if (child.state == State::kRunning && !child.killed) watch(child, now);
  }
  if (!stopping_ || !others_ended()) return;
  for (Child& child : children_) {
    if (!child.asked && !continues(child)) ask_to_end(child, now + grace_);
  }
}

/// Stopped, or in a paused container: the services, stopped as well, had no chance to give a sign or to end.
void Supervisor::exclude_standstill(Clock now) {
  const Clock away = updated_ == Clock(0) ? Clock(0) : now - updated_;
  updated_ = now;
  if (away < kStoodStill) return;
  for (Child& child : children_) {
    child.last_sign += away;
    child.kill_at += away;
  }
}

/// Kills one that hangs, or is still there although it was asked to end.
void Supervisor::watch(Child& child, Clock now) {
  const bool hung = hangs(child, now);
  if (child.asked ? now < child.kill_at : !hung) return;
  child.killed = true;
  host_.kill(child.process);
}

/// Silent for too long, and not because others took the processors: one that only waits for its turn would be no better
/// off after a restart.
bool Supervisor::hangs(Child& child, Clock now) {
  const std::uint64_t signs = host_.signs_of_life(child.process);
  if (const std::uint64_t before = std::exchange(child.signs_of_life, signs); before != signs) {
    child.work_done = before > 0 && signs == 0;
    child.last_sign = now;
    child.waited.reset();
  }
  const Clock silent = now - child.last_sign, hung_after(options_.hung_after_ms), begin = hung_after / 2;
  if (hung_after <= Clock(0) || signs == 0 || silent < begin) return false;
  if (!child.waited) child.waited = host_.waited_for_processor(child.process);
  if (silent < hung_after) return false;
  const Clock waited = host_.waited_for_processor(child.process) - *child.waited;
  return silent >= kMostPatience * hung_after || 2 * waited < silent - begin;
}

void Supervisor::stop(Clock now, Clock grace, RunOutcome why) {
  decide(why);
  const bool again = std::exchange(stopping_, true);
  rest_ends_ = rest_ends_ || again || why == RunOutcome::kInterrupted || why == RunOutcome::kConfigError;
  grace_ = grace;
  for (Child& child : children_) {
    if (continues(child)) continue;
    const Clock kill_at = child.asked ? std::min(child.kill_at, now + grace) : now + grace;
    if (again || !child.plan.ends_last || child.state != State::kRunning) ask_to_end(child, kill_at);
  }
}

void Supervisor::end_rest(Clock now, Clock grace) {
  rest_ends_ = true;
  for (Child& child : children_) ask_to_end(child, now + grace);
}

void Supervisor::ask_to_end(Child& child, Clock kill_at) {
  child.asked = true;
  child.kill_at = kill_at;
  if (child.state == State::kRunning) host_.terminate(child.process);
  if (child.state == State::kWaiting) child.state = State::kEnded;
}

bool Supervisor::others_ended() const {
  return std::ranges::all_of(children_, [](const Child& c) { return c.plan.ends_last || c.state == State::kEnded; });
}

bool Supervisor::all_ended() const {
  return std::ranges::all_of(children_, [this](const Child& c) { return continues(c) || c.state == State::kEnded; });
}

bool Supervisor::rest_runs() const {
  return std::ranges::any_of(children_, [](const Child& c) { return c.plan.outlives_run && c.state != State::kEnded; });
}

bool Supervisor::runs(const std::string& service) const {
  return std::ranges::any_of(children_,
                             [&](const Child& c) { return c.plan.name == service && c.state != State::kEnded; });
}

std::vector<std::pair<std::string, process::ProcessId>> Supervisor::running() const {
  std::vector<std::pair<std::string, process::ProcessId>> result;
  for (const Child& child : children_) {
    if (child.state == State::kRunning) result.emplace_back(child.plan.name, child.process);
  }
  return result;
}

void Supervisor::launch(Child& child, Clock now, const std::vector<std::string>& more_arguments) {
  std::vector<std::string> command = child.plan.command;
  command.insert(command.end(), more_arguments.begin(), more_arguments.end());
  child.process = host_.start({child.plan.name, command, child.plan.niceness});
  child.state = State::kRunning;
  child.started = now;
  child.killed = false;
  child.signs_of_life = 0;
}

void Supervisor::relaunch(Child& child, Clock now) {
  ++child.restarts;
  try {
    launch(child, now, child.plan.when_restarted ? child.plan.when_restarted() : std::vector<std::string>{});
  } catch (const process::ProcessError& error) {
    child.state = State::kEnded;
    report(SupervisorEvent::Kind::kGivenUp, child, child.plan.name + " could not be restarted: " + error.what());
    if (child.plan.role != ServiceRole::kOptional) decide(RunOutcome::kFailed);
    return;
  }
  report(SupervisorEvent::Kind::kRestarted, child,
         child.plan.name + " restarted (" + ordinal(child.restarts) + " time)");
}

void Supervisor::on_exit(Child& child, const process::ProcessExit& exit, Clock now) {
  child.state = State::kEnded;
  if (stopping_) {
    process::ProcessExit ended = exit;
    if (child.asked && exit.signal == SIGTERM) ended.signal = 0;  // asked before it handled signals
    const std::string how = !child.killed     ? " ended: " + describe(ended)
                            : child.work_done ? " had done its work, but its bus did not end: killed"
                                              : " did not end when asked and was killed";
    using Kind = SupervisorEvent::Kind;
    return report(child.killed ? Kind::kKilled : Kind::kEnded, child, child.plan.name + how, ended);
  }
  const bool source = child.plan.role == ServiceRole::kSource || child.plan.role == ServiceRole::kLive;
  if (source && exit.clean()) {
    report(SupervisorEvent::Kind::kEnded, child, child.plan.name + " reached the end of its source", exit);
    return decide(RunOutcome::kComplete);
  }
  const bool refused = exit.code == kExitUsageOrConfig || exit.code == kExitAlreadyRuns;
  if (exit.signal == 0 && refused && child.restarts == 0) {
    report(SupervisorEvent::Kind::kRefused, child, child.plan.name + " refused to start", exit);
    return decide(RunOutcome::kConfigError);
  }
  on_death(child, exit, now);
}

void Supervisor::on_death(Child& child, const process::ProcessExit& exit, Clock now) {
  const std::string hung = "hung for " + std::to_string(options_.hung_after_ms / 1000) + " s and was killed";
  const std::string how = child.killed ? hung : "died: " + describe(exit), what = child.plan.name + ' ' + how;
  const bool gave_up = exit.signal == 0 && !child.killed;
  if (child.plan.role == ServiceRole::kSource && (gave_up || !child.plan.when_restarted)) {
    report(SupervisorEvent::Kind::kGivenUp, child, what, exit, how);
    return decide(RunOutcome::kFailed);
  }
  if (child.plan.role == ServiceRole::kLive && gave_up && child.plan.has_served && !child.plan.has_served()) {
    report(SupervisorEvent::Kind::kGivenUp, child, what + " before its first frame: not started again", exit, how);
    return decide(RunOutcome::kFailed);
  }
  const bool healthy = now - child.started >= kHealthyAfter;
  child.deaths_in_row = healthy ? 1 : child.deaths_in_row + 1;
  if (child.deaths_in_row > options_.max_restarts) {
    const bool optional = child.plan.role == ServiceRole::kOptional;
    report(SupervisorEvent::Kind::kGivenUp, child,
           what + ", " + std::to_string(child.deaths_in_row) + " times in a row: given up" +
               (optional ? ", the run continues without it" : ""),
           exit, how);
    if (!optional) decide(RunOutcome::kFailed);
    return;
  }
  const Clock pause = healthy ? Clock(0) : backoff(options_, child.deaths_in_row);
  child.state = State::kWaiting;
  child.restart_at = now + pause;
  const std::string when = healthy ? "at once" : "in " + std::to_string(pause.count()) + " ms";
  report(SupervisorEvent::Kind::kDied, child, what + ", restart " + when, exit, how);
}

void Supervisor::decide(RunOutcome outcome) {
  if (outcome_ == RunOutcome::kRunning) outcome_ = outcome;
}

void Supervisor::report(SupervisorEvent::Kind kind, const Child& child, const std::string& text,
                        const process::ProcessExit& exit, const std::string& how) {
  if (on_event_) on_event_({kind, child.plan.name, text, child.process, exit, how});
}

}  // namespace rtd::launcher
