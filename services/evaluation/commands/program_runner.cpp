// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/program_runner.hpp"

#include <chrono>
#include <iostream>
#include <map>
#include <optional>

#include "common/process/posix_process_host.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::eval {
namespace {

constexpr std::chrono::milliseconds kPollPeriod{50};

class Runner {
 public:
  Runner(const std::vector<ProgramTask>& tasks, int jobs, const std::function<void(const ProgramResult&)>& on_done)
      : tasks_(tasks), on_done_(on_done), places_(static_cast<std::size_t>(jobs)) {}

  bool run(service::InterruptSignals& signals) {
    while (fill_places()) {
      host_.wait(kPollPeriod, signals.fd());
      if (signals.take() > 0) {
        end_all();
        return false;
      }
      collect();
    }
    return true;
  }

 private:
  struct Running {
    std::size_t task;
    process::ProcessId process;
    std::int64_t start_ns;
  };

  /// Returns false when nothing runs any more.
  bool fill_places() {
    bool any = false;
    for (std::size_t place = 0; place < places_.size(); ++place) {
      if (!places_[place] && next_ < tasks_.size()) {
        const process::ProcessId process = host_.start({std::to_string(next_), tasks_[next_](static_cast<int>(place))});
        places_[place] = {next_++, process, service::monotonic_ns()};
      }
      any = any || places_[place];
    }
    return any;
  }

  void collect() {
    for (std::optional<Running>& one : places_) {
      const auto exit = one ? host_.poll_exit(one->process) : std::nullopt;
      if (!exit) continue;
      const double duration_s = static_cast<double>(service::monotonic_ns() - one->start_ns) * 1e-9;
      const ProgramResult result{one->task, *exit, duration_s, lines_[std::to_string(one->task)]};
      one.reset();
      on_done_(result);
    }
  }

  void end_all() {
    for (const auto& one : places_) {
      if (one) host_.terminate(one->process);
    }
    for (const auto& one : places_) {
      while (one && !host_.poll_exit(one->process)) host_.wait(kPollPeriod);
    }
  }

  const std::vector<ProgramTask>& tasks_;
  const std::function<void(const ProgramResult&)>& on_done_;
  std::vector<std::optional<Running>> places_;
  std::size_t next_ = 0;
  std::map<std::string, std::string> lines_;  ///< the last ones
  process::PosixProcessHost host_{
      [this](const std::string& name, const std::string& line) { std::cerr << (lines_[name] = line) << std::endl; }};
};

}  // namespace

bool run_programs(const std::vector<ProgramTask>& tasks, int jobs, service::InterruptSignals& signals,
                  const std::function<void(const ProgramResult&)>& on_done) {
  return Runner(tasks, jobs, on_done).run(signals);
}

}  // namespace rtd::eval
