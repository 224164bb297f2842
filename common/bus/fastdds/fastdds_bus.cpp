// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/vendors.hpp"

#include <utility>

#include "common/bus/fastdds/calls.hpp"
#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/endpoints.hpp"
#include "common/bus/host/host_checks.hpp"

namespace rtd::bus::fastdds {
namespace {

class FastddsBackend : public BusBackend {
 public:
  FastddsBackend(std::shared_ptr<Participant> participant, bool shared_memory)
      : BusBackend("fastdds"), participant_(std::move(participant)), shared_memory_(shared_memory) {}

  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    auto codec = create_codec(id);
    const auto qos = writer_qos(settings(profile), codec->plain());
    return std::make_unique<FastddsWriter>(participant_, std::move(codec), topic, qos, std::move(callbacks));
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    auto codec = create_codec(id);
    const auto qos = reader_qos(settings(profile), codec->plain());
    return std::make_unique<FastddsReader>(participant_, std::move(codec), topic, qos, std::move(on_message),
                                           std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    return fastdds::create_calls(participant_, topics, role, std::move(on_call));
  }

 private:
  QosSettings settings(QosProfile profile) const {
    QosSettings settings = qos_settings(profile);
    settings.data_sharing = settings.data_sharing && shared_memory_;
    return settings;
  }

  std::shared_ptr<Participant> participant_;
  const bool shared_memory_;
};

class FastddsRawWriter : public RawWriter {
 public:
  FastddsRawWriter(std::shared_ptr<Participant> participant, const RawTopic& topic, const RawWriterOptions& options,
                   StatusCallbacks callbacks)
      : writer_(std::move(participant), create_raw_codec(topic, options), topic.name, raw_writer_qos(options),
                std::move(callbacks)) {}
  bool write(std::span<const std::byte> cdr, std::int64_t source_ns) override {
    const RawOutput output{cdr, source_ns};
    return writer_.write(&output);
  }
  int matched() const override { return writer_.matched(); }
  bool wait_acknowledged(int timeout_ms) override { return writer_.wait_acknowledged(timeout_ms); }

 private:
  FastddsWriter writer_;
};

class FastddsRawBus : public RegistryRawBus {
 public:
  FastddsRawBus(const BusOptions& options, const HostLimits& limits)
      : RegistryRawBus("fastdds"), participant_(std::make_shared<Participant>(options, limits, &registry_)) {}
  ~FastddsRawBus() override {
    registry_.watch(nullptr);
    participant_->silence();
  }

  std::unique_ptr<RawReader> reader(const RawTopic& topic, const RawReaderOptions& options,
                                    RawHandlers handlers) override {
    const StatusCallbacks status = handlers.status;
    return std::make_unique<FastddsReader>(participant_, create_raw_codec(topic, options), topic.name,
                                           raw_reader_qos(options), raw_callback(std::move(handlers)), status);
  }
  std::unique_ptr<RawWriter> writer(const RawTopic& topic, const RawWriterOptions& options,
                                    StatusCallbacks callbacks) override {
    return std::make_unique<FastddsRawWriter>(participant_, topic, options, std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    return fastdds::create_calls(participant_, topics, role, std::move(on_call));
  }

 private:
  std::shared_ptr<Participant> participant_;
};

/// The limits of this host, which must have enough shared memory.
HostLimits sufficient_limits(const BusOptions& options) {
  const HostLimits limits = read_host_limits();
  require_shared_memory(options, limits);
  return limits;
}

}  // namespace

std::shared_ptr<BusBackend> create_backend(const BusOptions& options) {
  return std::make_shared<FastddsBackend>(std::make_shared<Participant>(options, sufficient_limits(options)),
                                          options.shared_memory);
}

std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options) {
  return std::make_shared<FastddsRawBus>(options, sufficient_limits(options));
}

}  // namespace rtd::bus::fastdds
