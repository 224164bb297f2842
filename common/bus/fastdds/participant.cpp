// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/participant.hpp"

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <tuple>
#include <utility>

#include <fastdds/dds/log/Log.hpp>

#include "common/bus/fastdds/c_library.hpp"
#include "common/bus/fastdds/network_mapping.hpp"
#include "common/bus/fastdds/qos_mapping.hpp"
#include "common/bus/host/ring_folder.hpp"
#include "common/bus/library_log.hpp"
#include "common/bus/network.hpp"

#ifdef __SANITIZE_ADDRESS__
/// Fast DDS 2.9 deletes its statistics through a base class without virtual destructor; everything else stays checked.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "new_delete_type_mismatch=0";
}
#endif

namespace rtd::bus::fastdds {
namespace {

constexpr char kNoFreePort[] =
    "every port in shared memory is in use or was left by a killed process; samples go over UDP until the other "
    "processes of this domain have been restarted";
constexpr char kNoRings[] =
    "the folder of the rings of frames in /dev/shm cannot be made or belongs to another user too: frames are copied to "
    "each reader instead; remove it, or name another one with RTD_RINGS";
constexpr std::uint32_t kMinSegmentMib = 2;  // below it what does not fit is repaired in 20 ms instead

/// Fast DDS's own consumers write colours, and what they quote as it is.
class LogLines final : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    const char* const category = entry.context.category;
    log_.print(std::string(category != nullptr ? category : "") + ": " + entry.message);
  }

 private:
  LibraryLog log_{"Fast DDS"};
};

/// Fast DDS logs to stdout by default, which belongs to our programs' results. Two participants of one process send
/// each other their liveliness by direct calls by default, each under its own lock: when both do so at once, they wait
/// for each other forever.
void configure_library_once() {
  static std::once_flag once;
  std::call_once(once, [] {
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<LogLines>());
    dds::Log::SetVerbosity(dds::Log::Kind::Error);
    turn_off_direct_calls();
  });
}

/// Fast DDS makes a participant that discovers by announcements one that asks the server of this variable, whatever
/// its QoS say: what is not followed (common/service/bus_config.hpp) must not come in here.
class WithoutServerOfEnvironment {
 public:
  WithoutServerOfEnvironment() {
    if (const char* value = std::getenv(kVariable)) {
      value_ = value;
      ::unsetenv(kVariable);
    }
  }
  ~WithoutServerOfEnvironment() {
    if (value_) ::setenv(kVariable, value_->c_str(), 1);  // processes that we start read it too
  }
  WithoutServerOfEnvironment(const WithoutServerOfEnvironment&) = delete;
  WithoutServerOfEnvironment& operator=(const WithoutServerOfEnvironment&) = delete;

 private:
  static constexpr const char* kVariable = "ROS_DISCOVERY_SERVER";
  std::optional<std::string> value_;
};

/// Each has two ports of its domain. Domain 232 has fewer.
std::uint32_t participant_ids(int domain) {
  constexpr int kLastDomain = 232;
  return domain < kLastDomain ? 119 : 60;
}

/// Where a participant receives samples.
std::uint32_t sample_port(int domain, std::uint32_t id) {
  const rtps::PortParameters ports;
  return ports.getUnicastPort(static_cast<std::uint32_t>(domain), id) - ports.offsetd1 + ports.offsetd3;
}

std::string shm_name(std::uint32_t port) {
  return std::string(kShmPrefix).append(kShmPort) + std::to_string(port);
}

/// Whether this process has the lock by which others see that a port in shared memory is listened at.
bool listens_in_shm_at(std::uint32_t port) {
  const std::string lock = std::string(kShmFolder) + '/' + shm_name(port).append(kPortLock);
  std::error_code unreadable;
  for (const auto& file : std::filesystem::directory_iterator("/proc/self/fd", unreadable)) {
    std::error_code closed;
    if (std::filesystem::read_symlink(file, closed) == lock) return true;
  }
  return static_cast<bool>(unreadable);
}

/// The process id for the first participant of this process, far from it for the next: the numbers next to it are those
/// of processes that were started together.
std::uint32_t next_number() {
  constexpr std::uint32_t kApart = 31;
  static std::atomic<std::uint32_t> participants_so_far{0};
  return static_cast<std::uint32_t>(getpid()) + kApart * participants_so_far++;
}

dds::DomainParticipantQos participant_qos(const BusOptions& options, bool in_shared_memory, const HostLimits& limits,
                                          DiscoveryScope scope) {
  dds::DomainParticipantQos qos;
  qos.name(options.participant_name.empty() ? "rtd" : options.participant_name.c_str());
  const std::string user_data = participant_user_data(options);
  qos.user_data().setValue({user_data.begin(), user_data.end()});
  map_network(options, in_shared_memory, limits, scope, qos);
  map_security(options.security, qos);
  auto& builtin = qos.wire_protocol().builtin;
  // A killed process is forgotten after the lease; its heartbeat topic shows it much earlier.
  builtin.discovery_config.leaseDuration = {5, 0};
  builtin.discovery_config.leaseDuration_announcementperiod = {0, 500'000'000};
  return qos;
}

/// Fast DDS distinguishes the participants of a process by their ids, whatever their domains.
struct ParticipantsOfProcess {
  std::mutex creating;  // one at a time: Fast DDS asks getpwuid(), which is not thread-safe
  std::set<std::uint32_t> ids;
};

ParticipantsOfProcess& participants_of_process() {
  static ParticipantsOfProcess participants;
  return participants;
}

std::pair<dds::DomainParticipant*, std::uint32_t> create_participant(dds::DomainParticipantFactory& factory,
                                                                     const BusOptions& options,
                                                                     const HostLimits& limits, DiscoveryScope scope,
                                                                     dds::DomainParticipantListener* listener) {
  ParticipantsOfProcess& own = participants_of_process();
  const std::lock_guard lock(own.creating);
  const WithoutServerOfEnvironment announced;
  bool in_shared_memory = options.shared_memory && why_not_shared_memory(options, limits).empty();
  constexpr int kAttempts = 8;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    // Of two processes that find one port free at once, the second gets another than it announces: Fast DDS 3 then
    // receives nothing there. On an overloaded host the joins of those before take long; who was too late tries again.
    const ShmFolder one_process_at_a_time(kShmFolder, std::chrono::seconds(5));
    const std::uint32_t number = next_number();
    const auto free_id = free_participant_id(options.domain, number, own.ids);
    if (!free_id && std::exchange(in_shared_memory, false) && options.on_problem) options.on_problem(kNoFreePort);
    const std::uint32_t id = free_id.value_or(number % participant_ids(options.domain));
    dds::DomainParticipantQos qos = participant_qos(options, in_shared_memory, limits, scope);
    qos.wire_protocol().participant_id = static_cast<std::int32_t>(id);
    auto* participant = factory.create_participant(options.domain, qos, listener, dds::StatusMask::none());
    if (participant == nullptr) continue;  // the program that uses us may have participants, too
    if (!in_shared_memory || listens_in_shm_at(sample_port(options.domain, id))) {
      own.ids.insert(id);
      return {participant, id};
    }
    factory.delete_participant(participant);
  }
  throw BusError("Fast DDS refused to join domain " + std::to_string(options.domain) + "; " + kMayBeRefused);
}

}  // namespace

std::optional<std::uint32_t> free_participant_id(int domain, std::uint32_t first, const std::set<std::uint32_t>& taken,
                                                 const std::filesystem::path& shm_dir) {
  const std::uint32_t ids = participant_ids(domain);
  for (std::uint32_t step = 0; step < ids; ++step) {
    const std::uint32_t id = (first + step) % ids;
    if (taken.count(id) > 0) continue;
    std::error_code unreadable;
    if (!std::filesystem::exists(shm_dir / shm_name(sample_port(domain, id)), unreadable)) return id;
  }
  return std::nullopt;
}

Participant::Participant(const BusOptions& options, const HostLimits& limits, EndpointRegistry* registry,
                         std::shared_ptr<NodeEndpoints> node)
    : options_(options),
      node_endpoints_(node ? std::move(node) : std::make_shared<NodeEndpoints>()),
      listener_(options, registry) {
  if (options.shm_segment_mib < kMinSegmentMib || options.shm_segment_mib > 1024) {
    throw BusError("shared-memory segment of " + std::to_string(options.shm_segment_mib) +
                   " MiB, allowed: " + std::to_string(kMinSegmentMib) + "..1024");
  }
  link_c_library_functions();
  configure_library_once();
  factory_ = dds::DomainParticipantFactory::get_shared_instance();
  const DiscoveryScope scope = registry == nullptr ? DiscoveryScope::kMatching : DiscoveryScope::kAll;
  std::tie(participant_, participant_id_) = create_participant(*factory_, options, limits, scope, &listener_);
  if (options.security.enabled()) hide_shared_memory();
  listener_.start(*participant_, options);
  create_publishers(options.network);
}

/// Topics that stay on the host are in a partition of the host, so that no reader elsewhere is matched. Without a
/// network they need none, and any DDS program of this host may read them; our readers look into both.
void Participant::create_publishers(const NetworkOptions& network) {
  const std::string host = host_partition();
  dds::PublisherQos publisher = dds::PUBLISHER_QOS_DEFAULT;
  publisher_ = participant_->create_publisher(publisher);
  if (!network.loopback_only) publisher.partition().push_back(host.c_str());
  host_publisher_ = participant_->create_publisher(publisher);
  dds::SubscriberQos subscriber = dds::SUBSCRIBER_QOS_DEFAULT;
  subscriber_ = participant_->create_subscriber(subscriber);
  subscriber.partition().push_back("");
  subscriber.partition().push_back(host.c_str());
  host_subscriber_ = participant_->create_subscriber(subscriber);
}

std::string Participant::rings() const {
  if (!options_.shared_memory || !options_.uses_rings) return {};
  std::string folder = ring_folder(options_.rings);
  if (folder.empty() && options_.on_problem) options_.on_problem(kNoRings);
  return folder;
}

std::string Participant::ring_partitions(const std::string& folder, bool writes) const {
  if (folder.empty() || options_.rings.empty()) return {};
  std::string rings = "rings-" + std::to_string(ring_id(folder));
  return writes ? (options_.network.loopback_only ? "" : host_partition()) + ';' + rings : rings;
}

WriterId Participant::id() const {
  return to_writer_id(participant_->guid());
}

dds::Publisher& Participant::publisher(const std::string& topic) {
  return stays_on_host(topic) ? *host_publisher_ : *publisher_;
}

dds::Subscriber& Participant::subscriber(const std::string& topic) {
  return stays_on_host(topic) ? *host_subscriber_ : *subscriber_;
}

Participant::~Participant() {
  listener_.stop();
  silence();
  participant_->delete_contained_entities();
  factory_->delete_participant(participant_);
  ParticipantsOfProcess& own = participants_of_process();
  const std::lock_guard lock(own.creating);
  own.ids.erase(participant_id_);
}

dds::Topic* Participant::topic(const std::string& name, const Codec& codec) {
  const std::lock_guard lock(topics_mutex_);
  const dds::TypeSupport type = codec.create_type();
  if (auto* known = static_cast<dds::Topic*>(participant_->lookup_topicdescription(name))) {
    if (known->get_type_name() == type.get_type_name()) return known;
    throw BusError("topic " + name + " has type " + known->get_type_name() + ", not " + type.get_type_name());
  }
  if (participant_->find_type(type.get_type_name()).empty()) type.register_type(participant_);
  dds::Topic* topic = participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw BusError("Fast DDS refused topic " + name + " of type " + type.get_type_name());
  return topic;
}

/// A history of the policy that our readers have takes its largest sample from the type, once, and gives up larger ones
/// as samples that are gone. The type itself keeps what is announced to peers.
dds::DataReader* Participant::create_reader(dds::Topic& topic, const dds::DataReaderQos& qos, std::size_t largest,
                                            dds::DataReaderListener& listener) {
  const std::lock_guard lock(endpoints_mutex_);
  dds::TypeSupport type = participant_->find_type(topic.get_type_name());
  std::uint32_t& size = largest_sample(*type);
  const std::uint32_t announced = std::exchange(size, static_cast<std::uint32_t>(largest));
  dds::DataReader* const reader = subscriber(topic.get_name()).create_datareader(&topic, qos, &listener);
  size = announced;
  return reader;
}

}  // namespace rtd::bus::fastdds
