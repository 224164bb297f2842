// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/participant.hpp"

#include <dds/ddsrt/log.h>

#include <atomic>
#include <filesystem>
#include <utility>

#include "common/bus/cyclonedds/domain_config.hpp"
#include "common/bus/cyclonedds/local_sockets.hpp"
#include "common/bus/library_log.hpp"
#include "common/bus/network.hpp"
#include "common/bus/port_check.hpp"
#include "common/security/enclave.hpp"

namespace rtd::bus::cyclonedds {
namespace {

std::string text_of(const dds_log_data_t& line) {
  return shown_line({line.message, line.size});
}

/// That a domain of this process is kept to this host: that its network takes no multicast, while the cable is out, is
/// no loss then.
std::atomic<bool> kept_to_host{false};

bool is_no_loss(const std::string& line) {
  return kept_to_host && line.find("write to udp/239.255.0.1:") != std::string::npos;
}

/// Cyclone calls its sink from any thread, one call at a time or not.
void print_some(void* self, const dds_log_data_t* line) {
  const std::string text = text_of(*line);
  if (!is_no_loss(text)) static_cast<LibraryLog*>(self)->print(text);
}

/// Captures Cyclone's errors while it lives: they say why a call failed. Otherwise Cyclone's warnings and errors go to
/// stderr.
class LogCapture {
 public:
  LogCapture() { dds_set_log_sink(note, this); }
  ~LogCapture() {
    static LibraryLog log("Cyclone DDS");
    dds_set_log_sink(print_some, &log);
  }
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

  /// ": the errors so far", or nothing.
  std::string reason() const {
    const std::lock_guard lock(mutex_);
    return text_.empty() ? "" : ": " + text_;
  }

 private:
  static void note(void* self, const dds_log_data_t* line) {
    LogCapture& capture = *static_cast<LogCapture*>(self);
    const std::lock_guard lock(capture.mutex_);
    std::string& text = capture.text_;
    if (text.size() < 2000) text += (text.empty() ? "" : "; ") + text_of(*line);
  }

  mutable std::mutex mutex_;  ///< Cyclone logs from any of its threads
  std::string text_;
};

std::mutex& domains_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// A domain that is kept to this host is at all its addresses, where nothing comes in from elsewhere. Where the kernel
/// does not see to that, it is at loopback alone, and only programs that announce loopback are found.
dds_entity_t create_at(const BusOptions& options, const HostLimits& limits, DiscoveryPort port) {
  const std::vector<std::string> addresses =
      options.network.loopback_only && LocalSockets::available() ? host_addresses() : std::vector<std::string>();
  if (!addresses.empty()) {
    const LocalSockets sockets;
    const dds_entity_t domain =
        dds_create_domain(options.domain, domain_config(options, limits, port, addresses).c_str());
    if (domain >= 0 && sockets.bound() > 0) {
      kept_to_host = true;
      return domain;
    }
    if (domain >= 0) dds_delete(domain);
  }
  return dds_create_domain(options.domain, domain_config(options, limits, port).c_str());
}

/// When all ports that peers ask are taken, multicast still finds us.
std::shared_ptr<Domain> create_domain(const BusOptions& options, const HostLimits& limits, const std::string& config) {
  const LogCapture log;
  dds_entity_t handle = create_at(options, limits, DiscoveryPort::kOfPeers);
  if (handle < 0 && !takes_participant_port(options) && free_participant_ports(options.domain) == 0)
    handle = create_at(options, limits, DiscoveryPort::kAny);
  if (handle < 0) {
    throw BusError("Cyclone DDS refused to join domain " + std::to_string(options.domain) + " (" +
                   dds_strretcode(handle) + ")" + log.reason() + "; " + kMayBeRefused);
  }
  return {new Domain{config, Entity(handle)}, [](Domain* domain) {
            const std::lock_guard lock(domains_mutex());  // no connection joins while it ends
            delete domain;
          }};
}

/// Throws BusError: refused, with Cyclone's reason, or already there with other settings.
std::shared_ptr<Domain> join_domain(const BusOptions& options) {
  static std::map<std::uint32_t, std::weak_ptr<Domain>> domains;  // Cyclone's own table is per process, too
  const HostLimits limits = read_host_limits();
  const std::string config = domain_config(options, limits);
  const std::lock_guard lock(domains_mutex());
  if (const auto known = domains[options.domain].lock()) {
    if (known->config == config) return known;
    throw BusError("this process is in domain " + std::to_string(options.domain) +
                   " with other network settings; Cyclone DDS allows one set of them for a domain and process");
  }
  const auto domain = create_domain(options, limits, config);
  domains[options.domain] = domain;
  return domain;
}

/// The enclave's files as Cyclone's built-in plugins want them. No change without security.
void map_security(const SecurityOptions& security, const Qos& qos) {
  if (!security.enabled()) return;
  const security::EnclaveFiles files = security::KeystoreLayout{security.keystore}.enclave(security.enclave);
  const auto add = [&qos](const std::string& name, const std::string& value) {
    dds_qset_prop(qos.get(), ("dds.sec." + name).c_str(), value.c_str());
  };
  const auto file = [&add](const std::string& name, const std::filesystem::path& path) {
    add(name, "file:" + std::filesystem::absolute(path).string());
  };
  const auto plugin = [&add](const std::string& name, const std::string& library, const std::string& functions) {
    add(name + ".library.path", library);
    add(name + ".library.init", "init_" + functions);
    add(name + ".library.finalize", "finalize_" + functions);
  };
  plugin("auth", "dds_security_auth", "authentication");
  file("auth.identity_ca", files.identity_ca());
  file("auth.identity_certificate", files.certificate());
  file("auth.private_key", files.key());
  plugin("access", "dds_security_ac", "access_control");
  file("access.permissions_ca", files.permissions_ca());
  file("access.governance", files.governance());
  file("access.permissions", files.permissions());
  plugin("crypto", "dds_security_crypto", "crypto");
}

Entity create_participant(const BusOptions& options) {
  const Qos qos(dds_create_qos());
  dds_qset_entity_name(qos.get(), options.participant_name.empty() ? "rtd" : options.participant_name.c_str());
  const std::string user_data = participant_user_data(options);
  dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  map_security(options.security, qos);
  const LogCapture log;
  const dds_entity_t handle = dds_create_participant(options.domain, qos.get(), nullptr);
  if (handle < 0) {
    throw BusError("Cyclone DDS refused a participant in domain " + std::to_string(options.domain) + " (" +
                   dds_strretcode(handle) + ")" + log.reason());
  }
  return Entity(handle);
}

}  // namespace

WriterId guid_of(dds_entity_t entity) {
  WriterId id{};
  dds_guid_t guid{};
  if (dds_get_guid(entity, &guid) == DDS_RETCODE_OK) std::copy_n(guid.v, id.size(), id.begin());
  return id;
}

EndpointWatch::EndpointWatch(dds_entity_t participant, Direction direction, Note note) : note_(std::move(note)) {
  const Listener listener(dds_create_listener(this));
  dds_lset_data_available(listener.get(),
                          [](dds_entity_t, void* self) { static_cast<EndpointWatch*>(self)->take_all(); });
  const dds_entity_t topic =
      direction == Direction::kWriters ? DDS_BUILTIN_TOPIC_DCPSPUBLICATION : DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION;
  const dds_entity_t reader = dds_create_reader(participant, topic, nullptr, listener.get());
  if (reader < 0)
    throw BusError(std::string("Cyclone DDS refused to report other endpoints: ") + dds_strretcode(reader));
  {
    const std::lock_guard lock(mutex_);
    reader_ = reader;
  }
  take_all();  // those that were there before
}

EndpointWatch::~EndpointWatch() {
  dds_set_listener(reader_, nullptr);  // waits for a running one
  dds_delete(reader_);
}

void EndpointWatch::take_all() {
  constexpr std::size_t kAtOnce = 32;
  const std::lock_guard lock(mutex_);
  if (reader_ == 0) return;
  while (true) {
    void* samples[kAtOnce] = {};
    dds_sample_info_t infos[kAtOnce];
    const dds_return_t count = dds_take(reader_, samples, infos, kAtOnce, kAtOnce);
    if (count <= 0) return;
    for (int i = 0; i < count; ++i) {
      const auto* const endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      WriterId id{};
      std::copy_n(endpoint->key.v, id.size(), id.begin());
      const bool there = infos[i].instance_state == DDS_IST_ALIVE && infos[i].valid_data;
      note_(id, there ? endpoint : nullptr);
    }
    dds_return_loan(reader_, samples, count);
  }
}

Participant::Participant(const BusOptions& options, std::shared_ptr<NodeEndpoints> node)
    : unmatched_(UnmatchedWatch::start(options)),
      domain_(join_domain(options)),
      participant_(create_participant(options)),
      id_(guid_of(participant_.get())),
      loopback_only_(options.network.loopback_only),
      node_endpoints_(node ? std::move(node) : std::make_shared<NodeEndpoints>()) {}

void Participant::set_writer_partition(const std::string& topic, dds_qos_t& qos) const {
  if (loopback_only_ || !stays_on_host(topic)) return;
  dds_qset_partition1(&qos, host_partition().c_str());
}

void Participant::set_reader_partition(const std::string& topic, dds_qos_t& qos) const {
  if (!stays_on_host(topic)) return;
  const std::string host = host_partition();
  const char* both[] = {"", host.c_str()};
  dds_qset_partition(&qos, 2, both);
}

VendorTopic Participant::topic(const std::string& name, const SampleType& type) {
  const std::lock_guard lock(mutex_);
  if (const auto known = topics_.find(name); known != topics_.end()) {
    if (known->second.type == type) return known->second.vendor;
    throw BusError("topic " + name + " has type " + known->second.type.name + ", not " + type.name);
  }
  ddsi_sertype* vendor_type = create_sertype(type);
  const dds_entity_t handle =
      dds_create_topic_sertype(participant_.get(), name.c_str(), &vendor_type, nullptr, nullptr, nullptr);
  if (handle < 0) {
    destroy_sertype(vendor_type);
    throw BusError("Cyclone DDS refused topic " + name + " of type " + type.name + ": " + dds_strretcode(handle));
  }
  return topics_.emplace(name, KnownTopic{type, {handle, vendor_type}}).first->second.vendor;
}

TopicTypes& Participant::types() {
  const std::lock_guard lock(mutex_);
  const auto note = [this](const WriterId& id, const dds_builtintopic_endpoint_t* endpoint) {
    if (endpoint == nullptr) return types_.gone(to_string(id));
    if (!is_own(id)) types_.appeared(to_string(id), endpoint->topic_name, endpoint->type_name);
  };
  using Direction = EndpointWatch::Direction;
  if (!writers_) writers_ = std::make_unique<EndpointWatch>(participant_.get(), Direction::kWriters, note);
  if (!readers_) readers_ = std::make_unique<EndpointWatch>(participant_.get(), Direction::kReaders, note);
  return types_;
}

std::map<ParticipantId, std::string> Participant::participants() const {
  constexpr std::size_t kMax = 512;
  std::call_once(asked_, [this] {
    participants_ = dds_create_reader(participant_.get(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr);
  });
  std::map<ParticipantId, std::string> names;
  void* samples[kMax] = {};
  std::vector<dds_sample_info_t> infos(kMax);
  const std::uint32_t mask = DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE;
  const dds_return_t count = dds_read_mask(participants_, samples, infos.data(), kMax, kMax, mask);
  for (int i = 0; i < count; ++i) {
    const auto* const participant = static_cast<const dds_builtintopic_participant_t*>(samples[i]);
    char* name = nullptr;
    if (!infos[static_cast<std::size_t>(i)].valid_data || !dds_qget_entity_name(participant->qos, &name)) continue;
    ParticipantId id{};
    std::copy_n(participant->key.v, id.size(), id.begin());
    names.emplace(id, name);
    dds_free(name);
  }
  if (count > 0) dds_return_loan(participants_, samples, count);
  return names;
}

bool Participant::is_own(const WriterId& endpoint) const {
  constexpr std::ptrdiff_t kPrefix = 12;  // of the participant
  return std::equal(endpoint.begin(), endpoint.begin() + kPrefix, id_.begin());
}

}  // namespace rtd::bus::cyclonedds
