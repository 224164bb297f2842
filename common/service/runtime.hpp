// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/bus_factory.hpp"
#include "common/service/log.hpp"
#include "common/service/pacer.hpp"
#include "common/service/peer_clocks.hpp"
#include "common/service/peer_table.hpp"
#include "common/service/silent_inputs.hpp"
#include "common/service/stop_token.hpp"
#include "common/service/trace.hpp"

namespace rtd::service {

/// The name of this host; "localhost" when it has none.
std::string host_name();

/// Publishes the heartbeat of one service (topic rtd/status, 5 Hz and at changes) and knows those of the others.
/// Thread-safe.
class Heartbeat {
 public:
  /// Whether another process of the same name is worth an error in the log. It ends nothing: any program of the domain
  /// may say that it is one (ServiceLock finds the real ones).
  enum class SecondInstance { kReported, kAllowed };
  Heartbeat(bus::Bus& bus, std::string service_name, StopToken& stop,
            SecondInstance second_instance = SecondInstance::kReported);
  ~Heartbeat();

  void set_state(msg::ServiceState state, const std::string& message = {});
  /// A number shown in the heartbeat; the same name overwrites.
  void set_metric(const std::string& name, double value);
  /// A word shown in the heartbeat (msg::word_of); the same prefix overwrites.
  void set_word(const std::string& prefix, const std::string& word);
  /// A worker loop calls it in each round. If it is stuck for longer than the limit, the heartbeat has state degraded.
  void tick();
  /// The worker waits on purpose until the next tick.
  void idle();
  /// 0, the default: a worker never counts as stuck.
  void watch_progress(std::chrono::milliseconds limit);
  /// How the worker is, as the heartbeat sees it; stuck, too, when the bus lets no heartbeat out, or when nothing
  /// arrives on an input although its source says that it sends there.
  enum class Work { kNotBegun, kContinues, kStuck };
  Work work() const;
  /// False for a service that is dead, hung, or sent no heartbeat for 0.7 s.
  bool alive(const std::string& service) const;
  /// For paces whose results must not depend on the load of a host: it has never been there, has ended, its process is
  /// gone, or it was silent for 10 s while this process ran. Neither alive nor gone: it may be slow.
  bool gone(const std::string& service) const;
  bool ready(const std::string& service) const;  ///< alive and in state kReady, kRunning or kDegraded
  bool alone() const;                            ///< no other service has sent a heartbeat yet
  /// A metric of another service that is alive and runs on this host.
  std::optional<double> metric_on_this_host(const std::string& service, const std::string& metric) const;
  /// A word that another service has shown last (msg::word_of); empty when it has not.
  std::string word_of(const std::string& service, const std::string& prefix) const;
  /// Whether the process of a connection is known to have ended. To be used while this lives.
  std::function<bool(const bus::ParticipantId&)> process_gone() const {
    return [this](const bus::ParticipantId& connection) { return processes_.gone(connection); };
  }
  /// As PeerTable::accept_only_from().
  void accept_only_from(const std::string& service, std::weak_ptr<const bus::SourceGate> writers);
  /// `callback` runs on a bus thread for every heartbeat of another service. Waits for a running call: afterwards the
  /// earlier callback is not used any more. Not to be called from the callback itself.
  void on_status(std::function<void(const msg::ServiceStatus&)> callback);
  /// What its heartbeats carry, without what it knows of others.
  msg::ServiceStatus own_status() const {
    const std::lock_guard lock(mutex_);
    return own_;
  }
  /// What its heartbeats carry as ServiceStatus::started_ns.
  std::int64_t started_ns() const { return started_ns_; }

 private:
  void publish();
  void publish_end();
  bool check_peers();
  bool check_progress();
  bool check_inputs();
  bool check_topics();
  msg::ServiceStatus current_status();
  void receive(const msg::ServiceStatus& status, const bus::WriterId& writer);
  bool note(const msg::ServiceStatus& status, const bus::WriterId& writer);
  void report_second_instance(const msg::ServiceStatus& second, const bus::WriterId& writer);
  void exclude_standstill(std::int64_t now_ns);
  void forget_silent(std::int64_t now_ns);
  const Peer* find(const std::string& service) const;
  void loop();

  void set(const msg::Metric& metric);

  bus::Bus& bus_;
  StopToken& stop_;
  const SecondInstance second_instance_;
  const std::string own_name_;
  const std::int64_t started_ns_;
  std::atomic<std::int64_t> looked_ns_;  ///< when the last turn of the heartbeat's thread began
  ProcessRegistry processes_;
  mutable std::mutex mutex_;
  PeerClocks clocks_;
  msg::ServiceStatus own_;
  PeerTable peers_;
  std::mutex callback_mutex_;  ///< guards the callback, also while it runs
  std::function<void(const msg::ServiceStatus&)> callback_;
  ProgressWatch progress_;
  StandstillWatch standstill_;  ///< used by the heartbeat's thread
  SilentInputs inputs_;
  bool begun_ = false;
  std::string stuck_;  ///< why the worker counts as stuck; empty: it does not
  std::map<std::string, bus::TopicTrouble> troubles_;
  RateLimit second_instance_log_{std::chrono::seconds(30)};  ///< used by the reader's thread
  std::mutex publish_mutex_;
  bus::Writer<msg::ServiceStatus> writer_;
  bus::Reader<msg::ServiceStatus> reader_;
  StopToken ended_;
  std::thread thread_;
};

/// What a service adapter gets from the process around it.
struct Runtime {
  bus::Bus& bus;
  Heartbeat& heartbeat;
  StopToken& stop;
  Pace pace;
  bus::BusOptions bus_options;  ///< of `bus`, for a service that needs a further connection
  /// The service's results are written: from now on the process ends within seconds, whatever blocks a bus.
  std::function<void(int exit_code)> bound_end = [](int) {};
  Trace& trace = Trace::none();
};

}  // namespace rtd::service
