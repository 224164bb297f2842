// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace rtd::bus {

/// The bus thread of one endpoint: everything that its user is told is told here, one call at a time and under no lock
/// of the bus. Status events go before messages. Thread-safe.
class CallbackThread {
 public:
  /// `handle_one` hands one waiting message to the user; false when none waited.
  explicit CallbackThread(std::function<bool()> handle_one = {});
  ~CallbackThread() { stop(); }
  CallbackThread(const CallbackThread&) = delete;
  CallbackThread& operator=(const CallbackThread&) = delete;

  /// Runs a status event.
  void post(std::function<void()> event);
  /// There are messages to handle.
  void wake();
  /// Waits for a running callback and drops what still waits; later posts are ignored. Not to be called from a
  /// callback.
  void stop();

 private:
  void loop();

  const std::function<bool()> handle_one_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> events_;
  bool messages_waiting_ = false;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace rtd::bus
