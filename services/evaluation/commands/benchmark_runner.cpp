// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/benchmark_runner.hpp"

#include <algorithm>
#include <chrono>
#include <list>
#include <map>
#include <set>

#include "common/process/posix_process_host.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::eval {
namespace {

constexpr std::chrono::milliseconds kPollPeriod{50};

class Runner {
 public:
  Runner(const std::vector<ProgramTask>& tasks, int jobs, const std::function<void(const ProgramResult&)>& on_done)
      : tasks_(tasks), jobs_(static_cast<std::size_t>(jobs)), on_done_(on_done) {
    for (std::size_t i = 0; i < tasks.size(); ++i) pending_.push_back(i);
  }

  bool run(service::InterruptSignals& signals) {
    while (!pending_.empty() || !running_.empty()) {
      start_what_may();
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

  bool may_start(std::size_t task) const {
    const std::string& word = tasks_[task].first_of;
    if (word.empty() || made_.contains(word)) return true;
    return std::ranges::none_of(running_, [&](const Running& r) { return tasks_[r.task].first_of == word; });
  }

  void start_what_may() {
    for (auto next = pending_.begin(); next != pending_.end() && running_.size() < jobs_;) {
      if (!may_start(*next)) {
        ++next;
        continue;
      }
      const process::ProcessId process = host_.start({std::to_string(*next), tasks_[*next].command});
      running_.push_back({*next, process, service::monotonic_ns()});
      next = pending_.erase(next);
    }
  }

  void collect() {
    for (auto one = running_.begin(); one != running_.end();) {
      const auto exit = host_.poll_exit(one->process);
      if (!exit) {
        ++one;
        continue;
      }
      const double duration_s = static_cast<double>(service::monotonic_ns() - one->start_ns) * 1e-9;
      const ProgramResult result{one->task, *exit, duration_s, std::move(lines_[std::to_string(one->task)])};
      if (exit->clean()) made_.insert(tasks_[one->task].first_of);
      one = running_.erase(one);
      on_done_(result);
    }
  }

  void end_all() {
    for (const Running& one : running_) host_.terminate(one.process);
    std::erase_if(running_, [&](const Running& one) {
      while (!host_.poll_exit(one.process)) host_.wait(kPollPeriod);
      return true;
    });
  }

  void keep_line(const std::string& name, const std::string& line) {
    constexpr std::size_t kKept = 20;
    std::vector<std::string>& lines = lines_[name];
    lines.push_back(line);
    if (lines.size() > kKept) lines.erase(lines.begin());
  }

  const std::vector<ProgramTask>& tasks_;
  const std::size_t jobs_;
  const std::function<void(const ProgramResult&)>& on_done_;
  std::list<std::size_t> pending_;
  std::vector<Running> running_;
  std::set<std::string> made_;  ///< words of which one has ended well
  std::map<std::string, std::vector<std::string>> lines_;
  process::PosixProcessHost host_{[this](const std::string& name, const std::string& line) { keep_line(name, line); }};
};

}  // namespace

bool run_programs(const std::vector<ProgramTask>& tasks, int jobs, service::InterruptSignals& signals,
                  const std::function<void(const ProgramResult&)>& on_done) {
  return Runner(tasks, jobs, on_done).run(signals);
}

}  // namespace rtd::eval
