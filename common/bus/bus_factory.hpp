// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace rtd::bus {

/// Where a process looks for others, and how its datagrams are cut. Defaults: what suits the loopback interface.
struct NetworkOptions {
  bool loopback_only = true;
  std::vector<std::string> interfaces;
  bool multicast = true;
  std::vector<std::string> peers;
  std::string discovery_server;
  std::uint32_t max_datagram_bytes = 65000;  ///< <= 1400 where packets may get lost

  void bind(auto& binder) {
    binder.field("loopback_only", loopback_only, "false: also the host's network interfaces");
    binder.field("interfaces", interfaces, "names or IPv4 addresses to use besides loopback, e.g. eth0; none: all")
        .option("--interface", "Network");
    binder.field("multicast", multicast, "false: only peers and the discovery server are asked");
    binder.field("peers", peers, "hosts that are asked directly, HOST or HOST:PORT, e.g. 192.168.1.20,gpubox")
        .option("--peers", "Network");
    binder.field("discovery_server", discovery_server, "HOST:PORT of a Fast DDS Discovery Server")
        .option("--discovery-server", "Network");
    binder.field("max_datagram_bytes", max_datagram_bytes, {512, 65000}, "DDS cuts larger samples; 1400 on a network");
  }
};

/// DDS-Security: a keystore in the layout of sros2, and whose keys to use. Both empty: plain DDS.
struct SecurityOptions {
  std::string keystore;  ///< folder with public/, private/, enclaves/
  std::string enclave;   ///< path below enclaves/, e.g. "/rtd/slam"
  bool enabled() const { return !keystore.empty(); }
};

/// Fast DDS where it is built in, else Cyclone DDS.
std::string default_vendor();
/// "fastdds or cyclonedds": those that are built in.
std::string vendor_names();

/// A variable of the environment about DDS, what becomes of it here and, if it is not followed, what to write instead.
struct EnvironmentSetting {
  std::string text;
  bool followed = false;
  bool operator==(const EnvironmentSetting&) const = default;
};

/// bus.shm_segment_mib of a process that sends neither images nor clouds.
inline constexpr std::uint32_t kSmallSegmentMib = 4;

/// How our nodes are announced to ROS 2: identities have another size up to Humble than from Iron on.
enum class RosGraph { kOff, kHumble, kIron };

/// How a process joins the bus. Defaults: Fast DDS, loopback only.
struct BusOptions {
  std::string vendor = default_vendor();  ///< one of available_vendors()
  std::uint32_t domain = 0;
  std::string robot;             ///< its topics and frames, "": names as ever (common/bus/robot.hpp)
  std::string participant_name;  ///< shown by DDS tools, e.g. "rtd-filter"
  bool shared_memory = true;     ///< false where /dev/shm is tiny
  bool uses_rings = true;        ///< of frames; false: frames are copied to and from this process
  std::string rings;             ///< folder of the rings, "": that of this user (host/ring_folder.hpp)
  std::uint32_t shm_segment_mib = 16;
  std::uint32_t socket_buffer_kib = 4096;
  std::string ros_graph = "auto";  ///< auto counts as iron; common/service asks ROS_DISTRO before
  NetworkOptions network;
  SecurityOptions security;
  std::vector<EnvironmentSetting> environment;  ///< for messages: what it says is in the options already
  /// Called with one line for each problem that keeps other participants from being matched, e.g. a participant of
  /// another vendor in a secured domain. Runs on a bus thread, maybe several times: be brief, do not call the bus.
  std::function<void(const std::string& problem)> on_problem = {};
  /// Where the connection counts what it sends and receives. None: typed endpoints count for themselves, raw ones do
  /// not.
  std::shared_ptr<Traffic> traffic;

  void bind(auto& binder) {
    binder.field("vendor", vendor, "DDS implementation, else RTD_DDS: " + vendor_names()).option("--dds", "Network");
    binder.field("domain", domain, {0, 232}, "DDS domain, else ROS_DOMAIN_ID").option("--domain", "Network");
    binder.field("robot", robot, "name of the robot, where several share a domain: its topics and frames are below it")
        .option("--robot", "Robot");
    binder.field("shared_memory", shared_memory, "false: Fast DDS sends over UDP on one host too");
    binder.field("shm_segment_mib", shm_segment_mib, {2, 1024}, "shared-memory segment of this process");
    binder.field("socket_buffer_kib", socket_buffer_kib, {64, 65536}, "wanted UDP buffers, capped by the kernel");
    binder.choice("ros_graph", ros_graph, {"auto", "iron", "humble", "off"},
                  "form of the nodes for ROS 2: Iron and later, or up to Humble; auto: by ROS_DISTRO, else iron");
    binder.section("network", network);
  }
};

RosGraph ros_graph_of(const BusOptions& options);

/// The bus within one process that tests add: no network, no shared memory, no other process.
inline constexpr const char* kInprocess = "inprocess";

class RawBus;
/// What connects to a bus.
struct Vendor {
  const char* name;
  std::shared_ptr<BusBackend> (*create)(const BusOptions&);
  std::shared_ptr<RawBus> (*create_raw)(const BusOptions&);
  bool secures;  ///< honours BusOptions::security
};
/// For a bus that no build has. Not thread-safe.
void add_vendor(const Vendor& vendor);

/// Connects to the bus. Throws BusError: unknown vendor (with the list of those built in), domain out of range,
/// /dev/shm too small (with size and fix), participant refused.
std::shared_ptr<Bus> connect(const BusOptions& options);

/// Names accepted as BusOptions::vendor in this build.
std::vector<std::string> available_vendors();
/// Those of them that go from process to process.
std::vector<std::string> dds_vendors();

}  // namespace rtd::bus
