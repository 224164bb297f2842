// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/commands.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "services/viewer/core/command_forms.hpp"
#include "services/viewer/dispatcher.hpp"

namespace rtd::viewer {

/// Calls commands of the domain for clients, one after the other, in its own thread: a call may take seconds.
class CommandQueue {
 public:
  using Answer = std::function<void(CommandResult)>;

  /// Answers are ordered through the dispatcher. Throws BusError.
  CommandQueue(const bus::BusOptions& options, Dispatcher dispatcher);
  ~CommandQueue();
  CommandQueue(const CommandQueue&) = delete;
  CommandQueue& operator=(const CommandQueue&) = delete;

  /// What is offered now.
  std::vector<bus::FoundCommand> commands() const { return client_.commands(); }
  /// `name`: full, "/anna/slam/reset". `answer` is called in the viewer's thread; at once when too many calls wait.
  void call(const std::string& name, const std::string& argument, Answer answer);

 private:
  struct Call {
    std::string name, argument;
    Answer answer;
  };
  void work();
  CommandResult carry_out(const Call& call);

  const Dispatcher dispatcher_;
  bus::CommandClient client_;
  concurrency::BoundedQueue<Call> calls_{kMaxWaiting, concurrency::Overflow::kBlock};
  static constexpr std::size_t kMaxWaiting = 16;
  std::thread thread_;
};

}  // namespace rtd::viewer
