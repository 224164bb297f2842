// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/transport/transport_bench.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/bench/rtd_bench/transport/transport_worker.hpp"

namespace rtd::bench {
namespace {

/// A process that runs this executable again; what it writes to stdout is read at its end. Killed with this object.
class WorkerProcess {
 public:
  /// Throws std::runtime_error when it cannot be started.
  explicit WorkerProcess(const std::vector<std::string>& arguments);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  struct End {
    int code = -1;  ///< exit code; -1: killed, or not ended in time
    std::string output;
  };
  void ask_to_end() const;  ///< SIGTERM
  /// Waits for the end, then kills.
  End finish(std::chrono::seconds timeout);

 private:
  pid_t pid_ = 0;
  int output_ = -1;
};

WorkerProcess::WorkerProcess(const std::vector<std::string>& arguments) {
  int pipe_ends[2];
  if (pipe2(pipe_ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe to a worker");
  std::vector<std::string> words = {"rtd-bench"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDOUT_FILENO);
  const int failure = posix_spawn(&pid_, "/proc/self/exe", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(pipe_ends[1]);
  output_ = pipe_ends[0];
  if (failure != 0) {
    pid_ = 0;
    close(output_);
    throw std::runtime_error("cannot start a worker process");
  }
}

WorkerProcess::~WorkerProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(output_);
}

void WorkerProcess::ask_to_end() const {
  kill(pid_, SIGTERM);
}

WorkerProcess::End WorkerProcess::finish(std::chrono::seconds timeout) {
  End end;
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    pollfd readable{output_, POLLIN, 0};
    if (left.count() <= 0 || poll(&readable, 1, static_cast<int>(left.count())) <= 0) break;
    char buffer[65536];
    const ssize_t count = read(output_, buffer, sizeof(buffer));
    if (count <= 0) break;
    end.output.append(buffer, static_cast<std::size_t>(count));
  }
  if (std::chrono::steady_clock::now() >= deadline) kill(pid_, SIGKILL);
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = 0;
  end.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return end;
}

using nlohmann::json;

std::vector<std::string> worker_arguments(const std::string& role, const TransportCase& what,
                                          const TransportOptions& options) {
  return {"transport-worker",
          "--role",
          role,
          "--dds",
          what.vendor,
          "--path",
          to_string(what.path),
          "--payload",
          to_string(what.payload),
          "--domain",
          std::to_string(options.domain),
          "--messages",
          std::to_string(options.messages),
          "--rate",
          std::to_string(options.rate_hz),
          "--flood",
          std::to_string(options.flood_s)};
}

/// The JSON of a worker, or why there is none.
json result_of(const WorkerProcess::End& end, const std::string& role, std::string& failure) {
  const json result = json::parse(end.output, nullptr, false);
  if (end.code == 0 && result.is_object() && !result.contains("failure")) return result;
  if (failure.empty()) {
    failure = result.is_object() && result.contains("failure") ? result["failure"].get<std::string>()
                                                               : role + " process ended without a result";
  }
  return json::object();
}

TransportResult run_case(const TransportCase& what, const TransportOptions& options) {
  TransportResult result{what, {}, {}, {}};
  const auto longest = std::chrono::seconds(
      30 + static_cast<long>(options.flood_s + 2 * static_cast<double>(options.messages) / options.rate_hz));
  WorkerProcess subscriber(worker_arguments("subscribe", what, options));
  WorkerProcess publisher(worker_arguments("publish", what, options));
  const json published = result_of(publisher.finish(longest), "publisher", result.failure);
  subscriber.ask_to_end();
  const json received = result_of(subscriber.finish(std::chrono::seconds(10)), "subscriber", result.failure);
  if (!result.failure.empty()) return result;
  result.publisher = {published["bytes"], published["memcpy_us"], published["cpu_percent"], published["rate_hz"],
                      published["repeated"]};
  result.subscriber = {received["latency_us"], received["cpu_percent"]};
  return result;
}

}  // namespace

std::vector<TransportResult> bench_transport(const TransportOptions& options,
                                             const std::function<void(const TransportCase&)>& on_case) {
  std::vector<TransportResult> results;
  for (const TransportCase& what : transport_cases(options)) {
    on_case(what);
    results.push_back(run_case(what, options));
  }
  return results;
}

int run_transport_worker(const std::string& role, const TransportCase& what, const TransportOptions& options) {
  try {
    if (role == "publish") {
      const PublisherResult result = publish(what, options);
      std::cout << json{{"bytes", result.bytes},
                        {"memcpy_us", result.memcpy_us},
                        {"cpu_percent", result.cpu_percent},
                        {"rate_hz", result.rate_hz},
                        {"repeated", result.repeated}};
    } else {
      const SubscriberResult result = subscribe(what, options);
      std::cout << json{{"latency_us", result.latency_us}, {"cpu_percent", result.cpu_percent}};
    }
    return 0;
  } catch (const std::exception& error) {
    std::cout << json{{"failure", error.what()}};
    return 1;
  }
}

}  // namespace rtd::bench
