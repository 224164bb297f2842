// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/network_mapping.hpp"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <span>
#include <utility>

#include "common/bus/fastdds/qos_mapping.hpp"
#include "common/bus/fastdds/screening/ring_claims.hpp"
#include "common/bus/fastdds/screening/rtps_screen.hpp"
#include "common/bus/host/ring_folder.hpp"
#include "common/bus/network.hpp"
#include "common/bus/port_check.hpp"

namespace rtd::bus::fastdds {
namespace {

constexpr std::uint32_t kMib = 1024 * 1024, kLargestDatagram = 65500;
constexpr char kLoopback[] = "127.0.0.1", kAnyAddress[] = "0.0.0.0", kMulticastGroup[] = "239.255.0.1";
/// Of the server that `fast-discovery-server -i 0` starts.
constexpr char kServerGuidPrefix[] = "44.53.00.5f.45.50.52.4f.53.49.4d.41";

/// Port 0: the one that the domain and a participant id give.
rtps::Locator_t udp_locator(const std::string& address, std::uint32_t port = 0) {
  rtps::Locator_t locator;
  rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, address, port, locator);
  return locator;
}

std::shared_ptr<transports::SharedMemTransportDescriptor> shared_memory_transport(const BusOptions& options) {
  auto transport = std::make_shared<transports::SharedMemTransportDescriptor>();
  transport->segment_size(options.shm_segment_mib * kMib);
  transport->max_message_size(options.shm_segment_mib * kMib);
  return transport;
}

using OnProblem = std::function<void(const std::string&)>;

class ScreeningDescriptor : public transports::ChainingTransportDescriptor {
 public:
  ScreeningDescriptor(std::shared_ptr<transports::TransportDescriptorInterface> transport, std::uint32_t largest_sent,
                      RingClaims our_rings, OnProblem problem)
      : ChainingTransportDescriptor(std::move(transport)), rings(std::move(our_rings)), on_problem(std::move(problem)) {
    maxMessageSize = largest_sent;
  }
  std::uint32_t max_message_size() const override { return maxMessageSize; }
  transports::TransportInterface* create_transport() const override;

  const RingClaims rings;
  const OnProblem on_problem;
};

/// A transport that passes on only what an RtpsScreen passes: Fast DDS 2.9 as Debian builds it ends the process (an
/// assertion) on some datagrams that are no RTPS messages, reads fragments that are not there, and stands still while
/// it counts to a sequence number that is far away. Reports the first one to `on_problem`. Others' claims to rings of
/// ours are taken out.
///
/// One datagram at a time, though each socket has its own thread: in a secured domain Fast DDS 2.9 connects the
/// handshake of two participants that it discovers at once, by multicast and unicast, through one unguarded scratch
/// object. One of them was then never answered, one start in thirty of eight participants on a busy host.
///
/// Sends datagrams of at most `largest_sent` bytes and receives what the chained transport has room for: others, and
/// Cyclone DDS now and then, send larger ones than we do, whose end Fast DDS would cut off.
class ScreeningTransport : public PassingTransport {
 public:
  explicit ScreeningTransport(const ScreeningDescriptor& descriptor)
      : PassingTransport(descriptor), descriptor_(descriptor) {}

  transports::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  /// A program of this host that uses the network announces the host's address there, and may receive by no multicast.
  /// It listens at any address: where ours use loopback only, it is reached through that.
  bool reach(const rtps::Locator_t& remote, rtps::Locator_t& result) const override {
    if (!IsLocatorSupported(remote) || !is_own_address(rtps::IPLocator::toIPv4string(remote))) return false;
    result = remote;
    return rtps::IPLocator::setIPv4(result, kLoopback);
  }
  void receive(transports::TransportReceiverInterface* next, const rtps::octet* data, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    std::unique_lock one_at_a_time(mutex_);
    const auto message = std::as_bytes(std::span(data, size));
    const auto checked = screen_.passes(message) ? descriptor_.rings.checked(message) : std::nullopt;
    if (checked && !checked->empty()) data = reinterpret_cast<const rtps::octet*>(checked->data());
    if (checked) return next->OnDataReceived(data, size, local, remote);
    one_at_a_time.unlock();
    if (descriptor_.on_problem && !reported_.exchange(true))
      descriptor_.on_problem("malformed RTPS datagrams come from " + rtps::IPLocator::toIPv4string(remote) +
                             " and are dropped");
  }

 private:
  ScreeningDescriptor descriptor_;
  RtpsScreen screen_;
  std::atomic<bool> reported_{false};
  std::mutex mutex_;
};

transports::TransportInterface* ScreeningDescriptor::create_transport() const {
  return new ScreeningTransport(*this);
}

std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  return error ? 0 : bytes;
}

/// With security participants first send each other certificate and permissions, in messages that Fast DDS does not
/// cut: datagrams are then as large as these need (6 to 8 kB), and IP cuts them.
std::uint32_t datagram_bytes(const BusOptions& options) {
  constexpr std::uint64_t kKeysAndHeaders = 4096;
  const std::uint32_t asked = options.network.max_datagram_bytes;
  if (!options.security.enabled()) return asked;
  const std::filesystem::path enclave = options.security.keystore + "/enclaves/" + options.security.enclave;
  const std::uint64_t handshake =
      size_of(enclave / "cert.pem") + size_of(enclave / "permissions.p7s") + kKeysAndHeaders;
  return std::max(asked, static_cast<std::uint32_t>(std::min<std::uint64_t>(handshake, kLargestDatagram)));
}

std::shared_ptr<transports::UDPv4TransportDescriptor> udp_transport(const BusOptions& options,
                                                                    const HostLimits& limits) {
  auto transport = std::make_shared<transports::UDPv4TransportDescriptor>();
  transport->receiveBufferSize = socket_buffer_bytes(options.socket_buffer_kib, limits.rmem_max);
  transport->sendBufferSize = socket_buffer_bytes(options.socket_buffer_kib, limits.wmem_max);
  transport->maxMessageSize = kLargestDatagram;  // to receive
  transport->maxInitialPeersRange = kPeerParticipants;
  transport->interfaceWhiteList = interface_addresses(options.network);
  transport->interfaceWhiteList.emplace_back(kLoopback);
  return transport;
}

/// The first free discovery port of those that peers try: Fast DDS itself continues to the next while one is taken.
/// It is not the participant's id that follows the process id (participant.cpp). When none is left, the one of that id
/// does where multicast finds it.
void take_discovery_port(const BusOptions& options, rtps::BuiltinAttributes& builtin) {
  if (!takes_participant_port(options) && free_participant_ports(options.domain) == 0) {
    builtin.metatrafficUnicastLocatorList.push_back(udp_locator(kAnyAddress));
    return;
  }
  const std::uint32_t first_port = rtps::PortParameters().getUnicastPort(options.domain, 0);
  builtin.metatrafficUnicastLocatorList.push_back(udp_locator(kAnyAddress, first_port));
  builtin.mutation_tries = kPeerParticipants - 1;
}

/// Multicast is always received: it costs nothing, and tools of this host that keep to loopback are found. Loopback is
/// always asked: ROS 2 programs that are restricted to this host use no multicast.
void find_by_announcements(const BusOptions& options, rtps::BuiltinAttributes& builtin) {
  const NetworkOptions& network = options.network;
  builtin.metatrafficMulticastLocatorList.push_back(udp_locator(kMulticastGroup));
  take_discovery_port(options, builtin);
  if (network.multicast) builtin.initialPeersList.push_back(udp_locator(kMulticastGroup));
  builtin.initialPeersList.push_back(udp_locator(kLoopback));
  for (const std::string& peer : network.peers) {
    const HostAddress host = resolve_host(peer, "--peers");
    builtin.initialPeersList.push_back(udp_locator(host.address, host.port));
  }
}

void find_by_server(const BusOptions& options, DiscoveryScope scope, rtps::BuiltinAttributes& builtin) {
  const HostAddress host = resolve_host(options.network.discovery_server, "--discovery-server");
  builtin.discovery_config.discoveryProtocol =
      scope == DiscoveryScope::kAll ? DiscoveryProtocol::SUPER_CLIENT : DiscoveryProtocol::CLIENT;
  add_discovery_server(builtin, udp_locator(host.address, host.port), kServerGuidPrefix);
  builtin.metatrafficUnicastLocatorList.push_back(udp_locator(kAnyAddress));
}

}  // namespace

const ParticipantId& server_id() {
  static constexpr ParticipantId kId = {0x44, 0x53, 0x00, 0x5f, 0x45, 0x50, 0x52, 0x4f, 0x53, 0x49, 0x4d, 0x41};
  return kId;
}

void map_network(const BusOptions& options, bool in_shared_memory, const HostLimits& limits, DiscoveryScope scope,
                 dds::DomainParticipantQos& qos) {
  const std::string rings = options.shared_memory && options.uses_rings ? ring_folder(options.rings) : "";
  qos.transport().use_builtin_transports = false;
  if (in_shared_memory) qos.transport().user_transports.push_back(as_received(shared_memory_transport(options)));
  qos.transport().user_transports.push_back(std::make_shared<ScreeningDescriptor>(
      udp_transport(options, limits), datagram_bytes(options), RingClaims(rings, ring_id(rings)), options.on_problem));
  // Discovery over UDP only, samples over shared memory: the kernel closes the socket of a killed process at once.
  auto& builtin = qos.wire_protocol().builtin;
  if (options.network.discovery_server.empty()) {
    find_by_announcements(options, builtin);
  } else {
    find_by_server(options, scope, builtin);
  }
}

}  // namespace rtd::bus::fastdds
