// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// An attacker without keys: flood_peer VENDOR DOMAIN RATE_HZ [TOPIC]. Writes a message to every topic and sends a
// request to every command RATE_HZ times a second until SIGTERM, then prints how many; with TOPIC only to topics whose
// name contains it, and frames as often as anything else. A RATE_HZ of 0: without a pause, by writers and readers that
// come and go four times a second. What it writes is well-formed: in turn
// hostile values in one field after the other, and copies of what the real services have just sent with one thing
// changed.
#include <signal.h>
#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/command_codec.hpp"
#include "tests/fuzz/red/attack.hpp"
#include "tests/interop/bus/all_topics.hpp"

namespace rtd::flood {

volatile std::sig_atomic_t& stopped() {
  static volatile std::sig_atomic_t value = 0;
  return value;
}

namespace {

/// One topic or command under attack.
class Target {
 public:
  virtual ~Target() = default;
  virtual void attack(std::uint64_t turn) = 0;
  std::uint64_t written() const { return written_; }

 protected:
  std::uint64_t written_ = 0;
};

/// The newest message of another writer.
template <class T>
class NewestOfOthers {
 public:
  void put(std::shared_ptr<const T> message) {
    const std::lock_guard lock(mutex_);
    message_ = std::move(message);
  }
  std::shared_ptr<const T> get() const {
    const std::lock_guard lock(mutex_);
    return message_;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const T> message_;
};

/// What a copy pretends: to be the next message, or one of the far future, or of another state.
void change(msg::FeatureFrame& frame, std::uint64_t turn) {
  frame.seq += turn % 3 == 0 ? 1 : turn;
  for (msg::Feature& feature : frame.features) feature.depth_m *= 1.5F;
}
void change(msg::TrackingResult& result, std::uint64_t turn) {
  result.seq += turn % 3;
  result.T_world_camera.translation_m[0] += 1;
}
void change(msg::KeyframeEvent& event, std::uint64_t turn) {
  event.frame_seq += turn % 3;
  event.T_world_camera.translation_m[turn % 3] += 1;
}
void change(msg::ServiceStatus& status, std::uint64_t turn) {
  status.state = turn % 2 == 0 ? msg::ServiceState::kFinished : msg::ServiceState::kFailed;
  status.started_ns -= 1'000'000'000;
  status.pid += static_cast<std::int64_t>(turn % 5);
  status.message = "forged \x1b[2J\nevent=forged";
}
void change(msg::Detection2DArray& detections, std::uint64_t) {
  for (msg::Detection2D& detection : detections.detections) detection.bbox.size_x = detection.bbox.size_y = 2000;
}
template <std::uint32_t kWidth, std::uint32_t kHeight>
void change(msg::SizedFrame<kWidth, kHeight>& frame, std::uint64_t turn) {
  frame.seq = frame.seq + 1 + turn % 3;
  frame.stamp_ns = frame.stamp_ns + 1'000'000;
}
template <class T>
void change(T&, std::uint64_t) {}

template <class T>
class TopicTarget final : public Target {
 public:
  TopicTarget(bus::Bus& bus, const bus::Topic<T>& topic, bool spares_bandwidth)
      : spares_bandwidth_(spares_bandwidth),
        writer_(bus.writer(topic)),
        made_up_(bus::interop::message_of(topic, 0)),
        message_(std::make_unique<T>()) {
    reader_ =
        bus.template reader<T>(topic, [this](std::shared_ptr<const T> received) { newest_.put(std::move(received)); });
  }
  void attack(std::uint64_t turn) override {
    constexpr std::size_t kLarge = 1'000'000;
    if (spares_bandwidth_ && sizeof(T) > kLarge && turn % 10 != 0) return;
    const auto received = newest_.get();
    if (turn % 2 == 0 && received) {
      *message_ = *received;
      change(*message_, turn);
    } else {
      *message_ = *made_up_;
      attacker_.attack(*message_);
    }
    if (writer_.write(*message_)) ++written_;
  }

 private:
  const bool spares_bandwidth_;  ///< frames at a tenth of the rate: that memory bandwidth ends is no news
  bus::Writer<T> writer_;
  std::unique_ptr<T> made_up_, message_;
  testing::Attacker attacker_{1};
  NewestOfOthers<T> newest_;
  bus::Reader<T> reader_;
};

/// Requests that must be refused, whoever sends them; those that do what they say (reset, localize only, a real filter
/// mode) are for every client that may call commands.
class CommandTarget final : public Target {
 public:
  CommandTarget(bus::Bus& bus, const std::string& name, std::string argument)
      : calls_(bus.calls(bus::call_topics(name, bus::CommandKind::kText), bus::CallRole::kClient, [](auto&&...) {})),
        request_(bus::encode_request(bus::CommandKind::kText, {std::move(argument)})) {}
  void attack(std::uint64_t) override {
    if (calls_->matched_readers() > 0 && calls_->request(request_)) ++written_;
  }

 private:
  std::unique_ptr<bus::CallEndpoint> calls_;
  std::vector<std::byte> request_;
};

std::vector<std::unique_ptr<Target>> make_targets(bus::Bus& bus, const std::string& topics) {
  std::vector<std::unique_ptr<Target>> targets;
  bus::interop::for_each_topic([&]<class T>(const bus::Topic<T>& topic) {
    if (std::string(topic.name).find(topics) == std::string::npos) return;
    targets.push_back(std::make_unique<TopicTarget<T>>(bus, topic, topics.empty()));
  });
  if (!topics.empty()) return targets;
  for (const auto& [name, argument] : {std::pair("slam/save_map", "../../escaped"),
                                       {"slam/load_map", "/etc/passwd"},
                                       {"filter/set_mode", "no such mode"},
                                       {"recorder/start", "/tmp/escaped"}})
    targets.push_back(std::make_unique<CommandTarget>(bus, name, argument));
  return targets;
}

/// Does not return: with Fast DDS 2.9 the reader of frames that were overwritten before they were read may never end.
[[noreturn]] void flood(bus::Bus& bus, double rate_hz, const std::string& topics) {
  using std::chrono::duration;
  auto targets = make_targets(bus, topics);
  const bool churns = rate_hz == 0;
  const auto period = std::chrono::duration_cast<std::chrono::nanoseconds>(duration<double>(churns ? 0 : 1 / rate_hz));
  auto next = std::chrono::steady_clock::now(), made = next;
  std::uint64_t written = 0;
  const auto count = [&] {
    for (const auto& target : targets) written += target->written();
  };
  for (std::uint64_t turn = 0; stopped() == 0; ++turn) {
    for (const auto& target : targets)
      if (stopped() == 0) target->attack(turn);
    std::this_thread::sleep_until(next += period);
    if (!churns || std::chrono::steady_clock::now() - made < std::chrono::milliseconds(250)) continue;
    count();
    targets.clear();
    targets = make_targets(bus, topics);
    made = std::chrono::steady_clock::now();
  }
  count();
  std::printf("%llu messages written\n", static_cast<unsigned long long>(written));
  std::fflush(stdout);
  std::_Exit(0);
}

}  // namespace
}  // namespace rtd::flood

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) {
    std::fputs("usage: flood_peer VENDOR DOMAIN RATE_HZ [TOPIC]\n", stderr);
    return 2;
  }
  ::signal(SIGTERM, [](int) { rtd::flood::stopped() = 1; });
  // An attacker on this host could take the processor without any bus: what counts is what its messages cost others.
  ::setpriority(PRIO_PROCESS, 0, 19);
  rtd::bus::BusOptions options;
  options.vendor = argv[1];
  options.domain = static_cast<std::uint32_t>(std::atoi(argv[2]));
  options.participant_name = "flood";
  const auto bus = rtd::bus::connect(options);
  rtd::flood::flood(*bus, std::atof(argv[3]), argc > 4 ? argv[4] : "");
}
