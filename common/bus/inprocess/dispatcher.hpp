// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace rtd::bus::inprocess {

using Message = std::shared_ptr<const void>;

/// The bus thread of one endpoint: runs its callbacks one at a time, status events before messages. At most `depth`
/// messages wait; one more pushes the oldest out, as a keep-last history does. Thread-safe.
class Dispatcher {
 public:
  Dispatcher(std::size_t depth, std::function<void(Message)> on_message);
  /// Waits for a running callback, then drops what still waits.
  ~Dispatcher();
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  /// Never blocks. False when an older message had to go.
  bool deliver(Message message);
  void notify(std::function<void()> event);

 private:
  void loop();

  const std::size_t depth_;
  const std::function<void(Message)> on_message_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Message> messages_;
  std::deque<std::function<void()>> events_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace rtd::bus::inprocess
