// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/security_guard.hpp"

#include <ctime>
#include <utility>

#include "common/bus/prefixed_calls.hpp"

namespace rtd::bus {
namespace {

class Guard {
 public:
  explicit Guard(security::Enclave enclave) : enclave_(std::move(enclave)) {}
  void require_publish(const std::string& topic) const {
    if (!security::matches_any(enclave_.permissions.topics.publish, topic)) refuse("publish", topic);
  }
  void require_subscribe(const std::string& topic) const {
    if (!security::matches_any(enclave_.permissions.topics.subscribe, topic)) refuse("subscribe", topic);
  }
  void require_calls(const CallTopics& topics, CallRole role) const {
    require_subscribe(received_topic(topics, role).name);
    require_publish(sent_topic(topics, role).name);
  }

 private:
  [[noreturn]] void refuse(const std::string& action, const std::string& topic) const {
    throw BusError("enclave " + enclave_.name + " may not " + action + " topic " + topic +
                   ": allow it with 'rtd keystore renew KEYSTORE " + enclave_.name + " --" + action + " " + topic +
                   "', or choose another enclave with bus.security.enclave");
  }
  const security::Enclave enclave_;
};

class GuardedBus : public BusBackend {
 public:
  GuardedBus(std::shared_ptr<BusBackend> bus, security::Enclave enclave)
      : BusBackend(bus->vendor()), bus_(std::move(bus)), guard_(std::move(enclave)) {}
  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    guard_.require_publish(topic);
    return bus_->create_writer(id, topic, profile, std::move(callbacks));
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    guard_.require_subscribe(topic);
    return bus_->create_reader(id, topic, profile, std::move(on_message), std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    guard_.require_calls(topics, role);
    return bus_->create_calls(topics, role, std::move(on_call));
  }

 private:
  const std::shared_ptr<BusBackend> bus_;
  const Guard guard_;
};

class GuardedRawBus : public RawBus {
 public:
  GuardedRawBus(std::shared_ptr<RawBus> bus, security::Enclave enclave)
      : RawBus(bus->vendor()), bus_(std::move(bus)), guard_(std::move(enclave)) {}
  std::vector<TopicWriter> writers() const override { return bus_->writers(); }
  std::vector<TopicReader> readers() const override { return bus_->readers(); }
  std::map<ParticipantId, std::string> participants() const override { return bus_->participants(); }
  void watch(Watcher watcher) override { bus_->watch(std::move(watcher)); }
  std::unique_ptr<RawReader> make_reader(const RawTopic& topic, const RawReaderOptions& options,
                                         RawHandlers handlers) override {
    guard_.require_subscribe(topic.name);
    return bus_->reader(topic, options, std::move(handlers));
  }
  std::unique_ptr<RawWriter> make_writer(const RawTopic& topic, const RawWriterOptions& options,
                                         StatusCallbacks callbacks) override {
    guard_.require_publish(topic.name);
    return bus_->writer(topic, options, std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    guard_.require_calls(topics, role);
    return bus_->create_calls(topics, role, std::move(on_call));
  }

 private:
  const std::shared_ptr<RawBus> bus_;
  const Guard guard_;
};

}  // namespace

security::Enclave require_enclave(const BusOptions& options) {
  constexpr std::int64_t kWarn_s = 30 * 24 * 3600;
  const std::int64_t now_s = std::time(nullptr);
  try {
    security::Enclave enclave = security::open_enclave(options.security.keystore, options.security.enclave,
                                                       static_cast<int>(options.domain), now_s);
    if (options.on_problem && enclave.valid_until_s() - now_s < kWarn_s)
      options.on_problem("enclave " + enclave.name + " expires on " + security::to_utc(enclave.valid_until_s()) +
                         " UTC: renew it with 'rtd keystore renew " + options.security.keystore + "'");
    return enclave;
  } catch (const security::SecurityError& error) {
    throw BusError(std::string("--secure: ") + error.what());
  }
}

std::shared_ptr<BusBackend> guard(std::shared_ptr<BusBackend> bus, security::Enclave enclave) {
  return std::make_shared<GuardedBus>(std::move(bus), std::move(enclave));
}

std::shared_ptr<RawBus> guard(std::shared_ptr<RawBus> bus, security::Enclave enclave) {
  return std::make_shared<GuardedRawBus>(std::move(bus), std::move(enclave));
}

std::string other_vendor_problem(std::uint32_t domain, const std::string& participant, const std::string& vendor) {
  return "participant " + participant + " in secured domain " + std::to_string(domain) + " runs " + vendor +
         ": two vendors cannot agree on keys, so give all processes of a secured domain the same --dds";
}

std::string not_secured_problem(std::uint32_t domain, const std::string& participant) {
  return "participant " + participant + " in secured domain " + std::to_string(domain) +
         " has no certificate and is not matched: start it with --secure, or in another domain";
}

std::string refused_problem(std::uint32_t domain, const std::string& participant) {
  return "participant " + participant + " in secured domain " + std::to_string(domain) +
         " was refused: its certificate or permissions are expired or not of this keystore's CA (on its host: rtd "
         "keystore info)";
}

}  // namespace rtd::bus
