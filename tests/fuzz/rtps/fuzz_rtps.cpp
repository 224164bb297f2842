// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Malformed RTPS datagrams at each service of a real run: what the services say to each other is captured, changed and
// sent to them again; and well-formed RTPS with malformed samples. RTD_FUZZ_PACKETS: how many at each service and on
// each topic (default 300); RTD_FUZZ_SEED; RTD_FUZZ_SERVICES: at whom only, e.g. detector,record,launcher.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/fastdds/screening/rtps_screen.hpp"
#include "common/bus/raw_bus.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/fuzz/rtps/rtps_datagram.hpp"
#include "tests/fuzz/rtps/service_run.hpp"
#include "tests/support/loopback_capture.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::fuzz {
namespace {

/// Different RTPS datagrams to the ports of a DDS domain in the next while, at most `count` and few of a kind;
/// fragments of IP are left out.
std::vector<Bytes> datagram_seeds(test_support::LoopbackCapture& capture, std::uint32_t domain,
                                  std::chrono::milliseconds duration, std::size_t count) {
  constexpr std::uint32_t kPortBase = 7400, kPortsOfDomain = 250;
  constexpr std::size_t kHeader = 20;
  const std::uint32_t first_port = kPortBase + kPortsOfDomain * domain;
  constexpr int kAlike = 40;  // else nearly all were fragments of images
  std::unordered_map<std::string, Bytes> different;
  std::unordered_map<std::string, int> of_kind;
  const auto until = std::chrono::steady_clock::now() + duration;
  while (std::chrono::steady_clock::now() < until && different.size() < count) {
    auto packet = capture.next(std::chrono::milliseconds(50));
    if (!packet || packet->fragment || packet->payload.size() < kHeader) continue;
    const bool ours = packet->port >= first_port && packet->port < first_port + kPortsOfDomain;
    const auto* const begin = reinterpret_cast<const char*>(packet->payload.data());
    if (!ours || std::memcmp(begin, "RTPS", 4) != 0) continue;
    if (++of_kind[kind_of(packet->payload)] > kAlike) continue;
    different.try_emplace(std::string(begin, packet->payload.size()), std::move(packet->payload));
  }
  std::vector<Bytes> datagrams;
  for (auto& [text, bytes] : different) datagrams.push_back(std::move(bytes));
  return datagrams;
}

/// The UDP ports of a process, and a socket to send there over loopback no faster than it reads.
class UdpTarget {
 public:
  /// Ports from `first` to `last` that the process has bound.
  UdpTarget(pid_t process, std::uint32_t first, std::uint32_t last);
  ~UdpTarget();
  UdpTarget(const UdpTarget&) = delete;
  UdpTarget& operator=(const UdpTarget&) = delete;

  const std::vector<std::uint16_t>& ports() const { return ports_; }
  void send(const Bytes& datagram, std::uint16_t port) const;
  /// Waits until its sockets have been read empty, at most a while. False when they are not or the process is gone.
  bool wait_until_read() const;
  /// Datagrams that found no room in its sockets so far.
  std::uint64_t dropped() const;

 private:
  std::uint64_t drops_of_ports() const;

  const pid_t process_;
  std::uint64_t drops_before_ = 0;
  std::vector<std::uint16_t> ports_;
  int socket_;
};

namespace fs = std::filesystem;

struct UdpSocket {
  std::uint32_t port = 0;
  unsigned long queued_bytes = 0, inode = 0, drops = 0;
};

std::vector<UdpSocket> udp_sockets() {
  std::vector<UdpSocket> sockets;
  std::ifstream table("/proc/net/udp");
  for (std::string line; std::getline(table, line);) {
    UdpSocket socket;
    unsigned long sent = 0;
    if (std::sscanf(line.c_str(), " %*d: %*x:%x %*x:%*x %*x %lx:%lx %*x:%*x %*x %*u %*d %lu %*d %*x %lu", &socket.port,
                    &sent, &socket.queued_bytes, &socket.inode, &socket.drops) == 5)
      sockets.push_back(socket);
  }
  return sockets;
}

std::set<std::string> open_files(pid_t process) {
  std::set<std::string> files;
  std::error_code error;
  for (fs::directory_iterator file("/proc/" + std::to_string(process) + "/fd", error), end; !error && file != end;
       file.increment(error))
    files.insert(fs::read_symlink(file->path(), error).string());
  return files;
}

UdpTarget::UdpTarget(pid_t process, std::uint32_t first, std::uint32_t last)
    : process_(process), socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  const std::set<std::string> files = open_files(process);
  for (const UdpSocket& socket : udp_sockets()) {
    const bool own = files.contains("socket:[" + std::to_string(socket.inode) + "]");
    if (own && socket.port >= first && socket.port <= last) ports_.push_back(static_cast<std::uint16_t>(socket.port));
  }
  drops_before_ = drops_of_ports();
}

UdpTarget::~UdpTarget() {
  ::close(socket_);
}

void UdpTarget::send(const Bytes& datagram, std::uint16_t port) const {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ::sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

bool UdpTarget::wait_until_read() const {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (std::chrono::steady_clock::now() < give_up && ::kill(process_, 0) == 0) {
    unsigned long waiting = 0;
    for (const UdpSocket& socket : udp_sockets())
      if (std::find(ports_.begin(), ports_.end(), socket.port) != ports_.end()) waiting += socket.queued_bytes;
    if (waiting < 100'000) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

std::uint64_t UdpTarget::drops_of_ports() const {
  std::uint64_t drops = 0;
  for (const UdpSocket& socket : udp_sockets())
    if (std::find(ports_.begin(), ports_.end(), socket.port) != ports_.end()) drops += socket.drops;
  return drops;
}

std::uint64_t UdpTarget::dropped() const {
  const std::uint64_t drops = drops_of_ports();
  return drops > drops_before_ ? drops - drops_before_ : 0;  // of a dead process the ports are gone
}

std::uint64_t number(const char* variable, std::uint64_t otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

bool chosen(const std::string& service) {
  const char* const text = std::getenv("RTD_FUZZ_SERVICES");
  if (text == nullptr) return true;
  std::istringstream names(text);
  for (std::string name; std::getline(names, name, ',');)
    if (name == service) return true;
  return false;
}

/// Reads every topic, in another vendor where there is one: then the samples too go over UDP, and can be captured.
class Listener {
 public:
  explicit Listener(const std::string& vendor, std::uint32_t domain) {
    bus::BusOptions options;
    const std::vector<std::string> vendors = bus::available_vendors();
    const std::string other = vendor == "fastdds" ? "cyclonedds" : "fastdds";
    const bool there = std::find(vendors.begin(), vendors.end(), other) != vendors.end();
    options.vendor = there ? other : vendor;
    options.domain = domain;
    options.participant_name = "fuzz-listener";
    bus_ = bus::connect_raw(options);
    bus_->watch([this](const bus::TopicWriter& writer, bus::WriterChange change) {
      if (change != bus::WriterChange::kAppeared || topics_.contains(writer.topic.name)) return;
      try {
        topics_[writer.topic.name] = bus_->reader(writer.topic, {.reliable = writer.qos.reliable}, {});
      } catch (const bus::BusError&) {  // two types on a topic: one is enough
      }
    });
  }
  ~Listener() { bus_->watch(nullptr); }

 private:
  std::shared_ptr<bus::RawBus> bus_;
  std::map<std::string, std::unique_ptr<bus::RawReader>> topics_;
};

Bytes malformed(const std::vector<Bytes>& seeds, std::mt19937_64& random) {
  Bytes datagram = seeds[random() % seeds.size()];
  address_to_any_reader(datagram, random);
  if (random() % 3 != 0) mutate_submessages(datagram, random);
  if (random() % 3 == 0) datagram = fuzz::mutate(datagram, seeds[random() % seeds.size()], random);
  if (datagram.size() > 65000) datagram.resize(65000);
  return datagram;
}

class FuzzRtps : public ::testing::TestWithParam<std::string> {
 protected:
  /// Returns how many were received.
  std::uint64_t attack(ServiceRun& run, const std::string& service, const std::vector<Bytes>& seeds,
                       std::uint64_t packets) {
    const std::uint32_t first = 7400 + 250 * domain_;
    std::uint64_t received = 0;
    while (received < packets) {
      if (!run.wait_until_alive(service, std::chrono::seconds(20))) return received;
      const UdpTarget target(run.pid_of(service), first, first + 249);
      while (received < packets && run.lives(service) && !target.ports().empty()) {
        const std::uint64_t dropped = target.dropped(), sent = send_burst(target, seeds, packets - received);
        if (!target.wait_until_read() && run.lives(service)) {
          ADD_FAILURE() << service << " does not read its sockets any more";
          return received;
        }
        received += sent - std::min(sent, target.dropped() - std::min(target.dropped(), dropped));
        run.let_run(std::chrono::milliseconds(0));
      }
      if (target.ports().empty()) run.let_run(std::chrono::milliseconds(100));
    }
    return received;
  }

  /// As much as a socket has room for.
  std::uint64_t send_burst(const UdpTarget& target, const std::vector<Bytes>& seeds, std::uint64_t most) {
    constexpr std::uint64_t kPackets = 500;
    constexpr std::size_t kBytes = 300'000;
    std::uint64_t sent = 0;
    for (std::size_t bytes = 0; bytes < kBytes && sent < std::min(most, kPackets); ++sent) {
      const Bytes datagram = malformed(seeds, random_);
      sound_ += bus::read_rtps_message(datagram).well_formed ? 1 : 0;
      target.send(datagram, target.ports()[random_() % target.ports().size()]);
      bytes += datagram.size();
    }
    return sent;
  }

  const std::uint32_t domain_ = test_domain();
  std::uint64_t sound_ = 0;  ///< of those sent: with the frame of an RTPS message, malformed within
  std::mt19937_64 random_{number("RTD_FUZZ_SEED", 1)};
};

/// The suite has time for one of these.
bool asked_for() {
  return std::getenv("RTD_FUZZ_PACKETS") != nullptr;
}

TEST_P(FuzzRtps, services_survive_malformed_datagrams_or_are_restarted) {
  if (GetParam() != bus::dds_vendors().front() && !asked_for()) GTEST_SKIP() << "takes long: set RTD_FUZZ_PACKETS";
  test_support::LoopbackCapture capture;
  if (!capture.permitted()) GTEST_SKIP() << "capturing on the loopback interface needs root (CAP_NET_RAW)";
  ServiceRun run(GetParam(), domain_);
  ASSERT_TRUE(run.wait_for_frames()) << run.output();
  std::vector<Bytes> seeds;
  {
    const Listener listener(GetParam(), domain_);
    seeds = datagram_seeds(capture, domain_, std::chrono::seconds(3), 3000);
  }
  ASSERT_GT(seeds.size(), 100U) << "nothing to mutate";

  const std::uint64_t packets = number("RTD_FUZZ_PACKETS", 300);
  for (const std::string& service : run.services()) {
    if (!chosen(service)) continue;
    const auto begin = std::chrono::steady_clock::now();
    sound_ = 0;
    const std::uint64_t received = attack(run, service, seeds, packets);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    EXPECT_EQ(received, packets) << service << " did not come back\n" << run.output();
    std::printf("%s: %llu malformed datagrams of %zu seeds, %llu %% with a right frame, in %.0f s, %s\n",
                service.c_str(), static_cast<unsigned long long>(received), seeds.size(),
                static_cast<unsigned long long>(100 * sound_ / std::max<std::uint64_t>(1, received)), took.count(),
                run.lives(service) ? "lives" : "died");
    for (const std::string& line : run.take_deaths()) std::printf("  %s\n", line.c_str());
    std::fflush(stdout);
  }
  for (const std::string& service : run.services())
    EXPECT_TRUE(run.wait_until_alive(service, std::chrono::seconds(20))) << service << "\n" << run.output();
  run.end();
}

/// Genuine samples of each topic, by a reader of bytes.
class Samples {
 public:
  explicit Samples(bus::RawBus& bus) : bus_(bus) {
    bus_.watch([this](const bus::TopicWriter& writer, bus::WriterChange change) {
      if (change != bus::WriterChange::kAppeared || writer.own) return;
      const std::lock_guard lock(mutex_);
      Topic& topic = topics_[writer.topic.name];
      if (topic.reader != nullptr) return;
      topic.writer = writer;
      bus::RawHandlers handlers;
      handlers.on_sample = [this, &topic](const bus::RawSample& sample) {
        const std::lock_guard sample_lock(mutex_);
        if (topic.samples.size() < 20) topic.samples.emplace_back(sample.cdr().begin(), sample.cdr().end());
      };
      topic.reader = bus_.reader(
          writer.topic, {.transient_local = writer.qos.durability != bus::RawQos::Durability::kVolatile}, handlers);
    });
  }
  ~Samples() { stop(); }

  struct Topic {
    bus::TopicWriter writer;
    std::vector<Bytes> samples;
    std::unique_ptr<bus::RawReader> reader;
  };
  /// The samples so far; no more come.
  std::map<std::string, Topic>& stop() {
    bus_.watch(nullptr);
    for (auto& [name, topic] : topics_) topic.reader.reset();
    return topics_;
  }

 private:
  bus::RawBus& bus_;
  std::mutex mutex_;
  std::map<std::string, Topic> topics_;
};

/// Writes changed samples on the topic, no faster than its readers take them. Returns how many.
std::uint64_t write_malformed(bus::RawBus& bus, const Samples::Topic& topic, std::uint64_t count, ServiceRun& run,
                              std::mt19937_64& random) {
  bus::RawWriterOptions options{.qos = topic.writer.qos};
  options.qos.depth = 16;
  const auto writer = bus.writer(topic.writer.topic, options);
  for (int i = 0; i < 30 && writer->matched() == 0; ++i) run.let_run(std::chrono::milliseconds(50));
  if (writer->matched() == 0) return 0;  // it has no reader
  for (std::uint64_t i = 0; i < count; ++i) {
    const Bytes& sample = topic.samples[random() % topic.samples.size()];
    Bytes changed = fuzz::mutate(sample, topic.samples[random() % topic.samples.size()], random);
    if (changed.size() < 4) changed.resize(4);
    if (random() % 8 != 0) std::copy_n(sample.begin(), 4, changed.begin());  // mostly with a right header
    writer->write(changed);
    if (i % 16 != 15) continue;
    writer->wait_acknowledged(200);
    run.let_run(std::chrono::milliseconds(0));
  }
  writer->wait_acknowledged(2000);
  return count;
}

TEST_P(FuzzRtps, services_drop_malformed_samples_and_go_on) {
  if (!asked_for()) GTEST_SKIP() << "takes long: set RTD_FUZZ_PACKETS";
  ServiceRun run(GetParam(), domain_);
  ASSERT_TRUE(run.wait_for_frames()) << run.output();
  bus::BusOptions options;
  options.vendor = GetParam();
  options.domain = domain_;
  options.participant_name = "fuzz-writer";
  const auto bus = bus::connect_raw(options);
  Samples samples(*bus);
  run.let_run(std::chrono::seconds(4));
  const std::uint64_t packets = number("RTD_FUZZ_PACKETS", 300);
  std::uint64_t topics = 0;
  for (auto& [name, topic] : samples.stop()) {
    if (topic.samples.empty()) continue;
    constexpr std::uint64_t kLargeBytes = 1 << 20;  // of raw frames fewer: 1.5 MB each
    const std::uint64_t asked = topic.samples.front().size() > kLargeBytes ? 1 + packets / 50 : packets;
    const std::uint64_t written = write_malformed(*bus, topic, asked, run, random_);
    topics += written > 0 ? 1 : 0;
    std::printf("%s: %llu malformed samples\n", name.c_str(), static_cast<unsigned long long>(written));
    std::fflush(stdout);
  }
  EXPECT_GE(topics, 5U) << "on fewer topics than services read";
  for (const std::string& service : run.services())
    EXPECT_TRUE(run.wait_until_alive(service, std::chrono::seconds(20))) << service << "\n" << run.output();
  for (const std::string& line : run.take_deaths()) std::printf("  %s\n", line.c_str());
  run.end();
}

INSTANTIATE_TEST_SUITE_P(Vendors, FuzzRtps, ::testing::Values(RTD_FUZZ_VENDORS),
                         [](const auto& vendor) { return vendor.param; });

}  // namespace
}  // namespace rtd::fuzz
