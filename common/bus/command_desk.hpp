// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <future>
#include <list>
#include <mutex>
#include <string>

#include "common/bus/commands.hpp"

namespace rtd::bus {

/// The commands of a service that has a worker. Their handlers run on the worker's own thread, between two steps of its
/// work: they may touch all that the worker owns. The caller waits until it is their turn.
class CommandDesk {
 public:
  /// `wake`, if any, is called when a request came: the worker may be waiting for other things.
  explicit CommandDesk(Bus& bus, std::function<void()> wake = {}) : bus_(bus), wake_(std::move(wake)) {}
  ~CommandDesk() { close(); }
  CommandDesk(const CommandDesk&) = delete;
  CommandDesk& operator=(const CommandDesk&) = delete;

  /// As CommandServer. By the worker.
  void offer(const std::string& name, CommandKind kind, CommandServer::Handler handler);
  /// For work that is long: the handler runs on a thread of its own, beside the worker, and may call run().
  void offer_beside(const std::string& name, CommandKind kind, CommandServer::Handler handler);
  /// Runs it on the worker's thread and waits. Not by the worker.
  CommandAnswer run(std::function<CommandAnswer()> work);
  /// Runs the handlers of the requests that wait. By the worker, often.
  void serve();
  /// Answers what waits and what still comes with "the service is ending".
  void close();

 private:
  Bus& bus_;
  const std::function<void()> wake_;
  std::mutex mutex_;
  bool closed_ = false;
  std::deque<std::packaged_task<CommandAnswer()>> tasks_;
  std::list<CommandServer> servers_;  // last: they use the others
};

}  // namespace rtd::bus
