// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/bus/bus_factory.hpp"
#include "common/service/pacer.hpp"
#include "common/service/peer_clocks.hpp"
#include "common/service/peer_health.hpp"
#include "common/service/stop_token.hpp"
#include "common/service/trace.hpp"

namespace rtd::service {

/// How many frames the camera has sent, in its heartbeat.
inline constexpr char kFramesPublishedMetric[] = "frames_published";

/// Publishes the heartbeat of one service (topic rtd/status, 5 Hz and at changes) and knows those of the others.
/// Thread-safe.
class Heartbeat {
 public:
  /// What happens when an older process of the same name is found.
  enum class Twins {
    kRefused,  ///< this one asks for its stop
    kAllowed,
  };
  Heartbeat(bus::Bus& bus, std::string service_name, StopToken& stop, Twins twins = Twins::kRefused);
  ~Heartbeat();

  void set_state(msg::ServiceState state, const std::string& message = {});
  /// A number shown in the heartbeat; the same name overwrites.
  void set_metric(const std::string& name, double value);
  /// A worker loop calls it in each round. If it is stuck for longer than the limit, the heartbeat has state degraded.
  void tick();
  /// The worker waits on purpose until the next tick.
  void idle();
  /// A frame of the camera arrived. If no other follows although the camera sends them on this host, the worker counts
  /// as stuck: its reader is lost.
  void frame_received();
  /// 0, the default: a worker never counts as stuck.
  void watch_progress(std::chrono::milliseconds limit);
  /// How the worker is, as the heartbeat sees it; stuck, too, when the bus lets no heartbeat out.
  enum class Work { kNotBegun, kGoesOn, kStuck };
  Work work() const;
  /// False for a service that is dead, hung, or sent no heartbeat for 0.7 s.
  bool alive(const std::string& service) const;
  bool ready(const std::string& service) const;  ///< alive and in state kReady, kRunning or kDegraded
  bool alone() const;                            ///< no other service has sent a heartbeat yet
  /// A metric of another service that is alive and runs on this host.
  std::optional<double> metric_on_this_host(const std::string& service, const std::string& metric) const;
  /// `callback` runs on a bus thread for every heartbeat of another service. Waits for a running call: afterwards the
  /// earlier callback is not used any more. Not to be called from the callback itself.
  void on_status(std::function<void(const msg::ServiceStatus&)> callback);
  /// Message when an older instance of the same service runs in this domain; empty otherwise.
  std::string duplicate() const;
  /// What its heartbeats carry as ServiceStatus::started_ns.
  std::int64_t started_ns() const { return started_ns_; }

 private:
  struct Peer {
    msg::ServiceStatus status;
    std::int64_t received_ns = 0;
    PeerHealth health = PeerHealth::kAlive;
  };
  void publish();
  void publish_end();
  bool check_peers();
  bool check_progress();
  bool check_topics();
  msg::ServiceStatus current_status();
  void receive(const msg::ServiceStatus& status);
  void loop();

  void set(const msg::Metric& metric);

  bus::Bus& bus_;
  StopToken& stop_;
  const Twins twins_;
  const std::int64_t started_ns_;
  std::atomic<std::int64_t> looked_ns_;  ///< when the last turn of the heartbeat's thread began
  mutable std::mutex mutex_;
  PeerClocks clocks_;
  msg::ServiceStatus own_;
  std::map<std::string, Peer> peers_;
  std::mutex callback_mutex_;  ///< guards the callback, also while it runs
  std::function<void(const msg::ServiceStatus&)> callback_;
  std::string duplicate_;
  ProgressWatch progress_;
  InputWatch frames_;
  bool begun_ = false;
  std::string stuck_;  ///< why the worker counts as stuck; empty: it does not
  std::map<std::string, bus::TopicTrouble> troubles_;
  std::pair<std::int64_t, std::int64_t> twin_{};  ///< pid and start of an older instance that was seen once
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
