// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/bus/qos.hpp"

namespace rtd::bus {

/// The bus thread of one endpoint: all callbacks of its user run here, one at a time and under no lock of the bus.
/// Status events go before messages. Thread-safe.
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

/// Calls the StatusCallbacks of one endpoint on its bus thread. Thread-safe.
class StatusReporter {
 public:
  /// `thread` may be used until it has been stopped.
  StatusReporter(StatusCallbacks callbacks, CallbackThread& thread)
      : callbacks_(std::move(callbacks)), thread_(&thread) {}
  /// For writers: with its own thread if there is anything to call.
  explicit StatusReporter(StatusCallbacks callbacks);

  const StatusCallbacks& callbacks() const { return callbacks_; }
  int matched() const { return matched_; }

  void report_matched(int peers);
  void report_liveliness(int alive) { post(callbacks_.on_liveliness, alive); }
  void report_deadline_missed() { post(callbacks_.on_deadline_missed); }
  void report_incompatible_qos(const std::string& policy) { post(callbacks_.on_incompatible_qos, policy); }
  void report_type_mismatch(const std::string& type) { post(callbacks_.on_type_mismatch, type); }
  void report_writer(const WriterId& writer, bool matched) { post(callbacks_.on_writer, writer, matched); }
  void report_lost(int total) { post(callbacks_.on_samples_lost, total); }
  void report_rejected(int total) { post(callbacks_.on_samples_rejected, total); }
  void report_too_large() { post(callbacks_.on_too_large); }

 private:
  template <class Callback, class... Values>
  void post(const Callback& callback, Values... values) {
    if (callback) thread_->post([&callback, values...] { callback(values...); });
  }

  const StatusCallbacks callbacks_;
  std::atomic<int> matched_{0};
  CallbackThread* thread_ = nullptr;
  std::optional<CallbackThread> own_;
};

}  // namespace rtd::bus
