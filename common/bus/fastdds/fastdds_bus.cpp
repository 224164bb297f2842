// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/vendors.hpp"

#include <memory>
#include <utility>

#include "common/bus/backend.hpp"
#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/endpoints.hpp"
#include "common/bus/fastdds/message_type.hpp"
#include "common/bus/fastdds/participant.hpp"
#include "common/bus/host/host_checks.hpp"
#include "common/bus/prefixed_calls.hpp"
#include "common/bus/ros_graph.hpp"

namespace rtd::bus::fastdds {
namespace {

/// What the codec writes: the bytes, and the identities next to them, which Fast DDS completes.
struct CallOutput {
  std::span<const std::byte> cdr;
  rtps::WriteParams& params;
};

/// What the codec takes.
struct CallSample {
  rtps::SampleIdentity own, related;
  ByteBlock bytes;
};

class CallCodec : public Codec {
 public:
  CallCodec(RawTopic topic, CallRole role)
      : topic_(std::move(topic)), largest_(call_reader_options(role).largest_sample) {}
  bool plain() const override { return false; }
  std::size_t largest_sample() const override { return largest_; }
  dds::TypeSupport create_type() const override { return dds::TypeSupport(new RawType(topic_, false, 0)); }
  bool write(dds::DataWriter& writer, const void* message) const override {
    const CallOutput& output = *static_cast<const CallOutput*>(message);
    RawData data{output.cdr, nullptr};
    return succeeded(writer.write(&data, output.params));
  }
  TakenSample take(dds::DataReader& reader, const Accepts&) override {
    auto sample = std::make_shared<CallSample>();
    RawData data{{}, &sample->bytes};
    dds::SampleInfo info;
    if (!succeeded(reader.take_next_sample(&data, &info))) return {};
    if (!info.valid_data) return {TakenSample::Kind::kNoData};
    sample->own = info.sample_identity;
    sample->related = info.related_sample_identity;
    return {TakenSample::Kind::kMessage, std::move(sample), to_writer_id(info.sample_identity.writer_guid())};
  }
  std::shared_ptr<void> allocate() const override { throw BusError("a service lends no memory"); }

 private:
  const RawTopic topic_;
  const std::size_t largest_;
};

CallId to_call_id(const rtps::SampleIdentity& identity) {
  return {to_writer_id(identity.writer_guid()), static_cast<std::int64_t>(identity.sequence_number().to64long())};
}

rtps::SampleIdentity to_identity(const CallId& id) {
  rtps::SampleIdentity identity;
  rtps::GUID_t& guid = identity.writer_guid();
  std::copy_n(id.client.begin(), rtps::GuidPrefix_t::size, guid.guidPrefix.value);
  std::copy_n(id.client.begin() + rtps::GuidPrefix_t::size, rtps::EntityId_t::size, guid.entityId.value);
  identity.sequence_number() = rtps::SequenceNumber_t(static_cast<std::uint64_t>(id.sequence));
  return identity;
}

/// RTPS 2.2, 9.3.1.5: a GUID begins with the vendor.
bool is_of_cyclonedds(const rtps::GUID_t& guid) {
  return guid.guidPrefix.value[0] == 0x01 && guid.guidPrefix.value[1] == 0x10;
}

class FastddsCalls : public CallEndpoint {
 public:
  FastddsCalls(std::shared_ptr<Participant> participant, const RawTopic& sent, const RawTopic& received, CallRole role,
               OnCall on_call)
      : role_(role),
        on_call_(std::move(on_call)),
        writer_(participant, std::make_unique<CallCodec>(sent, role), sent.name, raw_writer_qos(call_writer_options()),
                {}),
        reader_(participant, std::make_unique<CallCodec>(received, role), received.name,
                raw_reader_qos(call_reader_options(role)),
                [this](const std::shared_ptr<const void>& sample, const WriterId&) {
                  receive(*static_cast<const CallSample*>(sample.get()));
                },
                {}) {}

  std::optional<CallId> request(std::span<const std::byte> cdr) override {
    rtps::WriteParams params;
    params.related_sample_identity().writer_guid(reader_.guid());
    if (!write(cdr, params)) return std::nullopt;
    rtps::SampleIdentity sent = params.sample_identity();
    sent.writer_guid(reader_.guid());
    return to_call_id(sent);
  }
  bool reply(const CallId& id, std::span<const std::byte> cdr) override {
    rtps::WriteParams params;
    if (is_prefixed(id)) return write(with_prefix(id, cdr), params);
    params.related_sample_identity(to_identity(id));
    return write(cdr, params);
  }
  int matched_readers() const override { return writer_.matched(); }
  int matched_writers() const override { return reader_.matched(); }
  bool reaches(const CallId& id) const override {
    const rtps::GUID_t client = to_identity(id).writer_guid();
    const bool names_reader = !is_prefixed(id) && client.entityId.is_reader();
    return names_reader ? writer_.matches(client) : CallEndpoint::reaches(id);
  }

 private:
  bool write(std::span<const std::byte> cdr, rtps::WriteParams& params) {
    const CallOutput output{cdr, params};
    return writer_.write(&output);
  }
  void receive(const CallSample& sample) const {
    const auto cdr = sample.bytes.view();
    if (role_ == CallRole::kServer && is_of_cyclonedds(sample.own.writer_guid())) {
      if (const std::optional<PrefixedCall> call = split_prefix(cdr)) on_call_(call->id, call->cdr);
    } else if (role_ == CallRole::kServer) {
      rtps::SampleIdentity asked = sample.own;
      if (sample.related.writer_guid() != rtps::GUID_t::unknown()) asked.writer_guid(sample.related.writer_guid());
      on_call_(to_call_id(asked), cdr);
    } else {
      rtps::SampleIdentity answered = sample.related;
      if (answered.writer_guid() == writer_.guid()) answered.writer_guid(reader_.guid());
      if (answered.writer_guid() == reader_.guid()) on_call_(to_call_id(answered), cdr);
    }
  }

  const CallRole role_;
  const OnCall on_call_;
  FastddsWriter writer_;
  FastddsReader reader_;  // last: it uses the others
};

/// One end of a service as rmw_fastrtps has it: the identities travel next to the samples, in their inline QoS. A
/// request is known by its number and by the GUID of the reader that waits for the reply, which the client announces as
/// related identity; older clients (ROS 2 Foxy) announce none and mean their writer. A server answers clients of
/// rmw_cyclonedds too, as they ask: their GUIDs say whose they are.
std::unique_ptr<CallEndpoint> create_calls(std::shared_ptr<Participant> participant, const CallTopics& topics,
                                           CallRole role, OnCall on_call) {
  return std::make_unique<FastddsCalls>(std::move(participant), sent_topic(topics, role), received_topic(topics, role),
                                        role, std::move(on_call));
}

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

NodeAnnouncer::CreateWriter writers_of(const std::shared_ptr<Participant>& participant) {
  return [participant](const RawTopic& topic, const RawWriterOptions& options) {
    return std::make_unique<FastddsRawWriter>(participant, topic, options, StatusCallbacks());
  };
}

class FastddsBackend : public BusBackend {
 public:
  FastddsBackend(const std::shared_ptr<Participant>& participant, const BusOptions& options)
      : BusBackend("fastdds"),
        participant_(participant),
        announcer_(participant->node_endpoints(), participant->id(), options, writers_of(participant)) {}

  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    auto codec = create_codec(id);
    const auto qos = writer_qos(qos_settings(profile), codec->plain());
    return std::make_unique<FastddsWriter>(participant_, std::move(codec), topic, qos, std::move(callbacks));
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    auto codec = create_codec(id);
    const auto qos = reader_qos(qos_settings(profile), codec->plain());
    return std::make_unique<FastddsReader>(participant_, std::move(codec), topic, qos, std::move(on_message),
                                           std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    return fastdds::create_calls(participant_, topics, role, std::move(on_call));
  }

 private:
  std::shared_ptr<Participant> participant_;
  NodeAnnouncer announcer_;
};

class FastddsRawBus : public RegistryRawBus {
 public:
  FastddsRawBus(const BusOptions& options, const HostLimits& limits)
      : RegistryRawBus("fastdds"),
        participant_(std::make_shared<Participant>(options, limits, &registry_)),
        announcer_(participant_->node_endpoints(), participant_->id(), options, writers_of(participant_)) {}
  ~FastddsRawBus() override {
    registry_.watch(nullptr);
    participant_->silence();
  }

  std::unique_ptr<RawReader> make_reader(const RawTopic& topic, const RawReaderOptions& options,
                                         RawHandlers handlers) override {
    const StatusCallbacks status = handlers.status;
    return std::make_unique<FastddsReader>(participant_, create_raw_codec(topic, options), topic.name,
                                           raw_reader_qos(options), raw_callback(std::move(handlers)), status);
  }
  std::unique_ptr<RawWriter> make_writer(const RawTopic& topic, const RawWriterOptions& options,
                                         StatusCallbacks callbacks) override {
    return std::make_unique<FastddsRawWriter>(participant_, topic, options, std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    return fastdds::create_calls(participant_, topics, role, std::move(on_call));
  }

 private:
  std::shared_ptr<Participant> participant_;
  NodeAnnouncer announcer_;
};

/// The limits of this host, which must have enough shared memory.
HostLimits sufficient_limits(const BusOptions& options) {
  const HostLimits limits = read_host_limits();
  require_shared_memory(options, limits);
  return limits;
}

}  // namespace

std::shared_ptr<BusBackend> create_backend(const BusOptions& options, std::shared_ptr<NodeEndpoints> node) {
  return std::make_shared<FastddsBackend>(
      std::make_shared<Participant>(options, sufficient_limits(options), nullptr, std::move(node)), options);
}

std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options) {
  return std::make_shared<FastddsRawBus>(options, sufficient_limits(options));
}

}  // namespace rtd::bus::fastdds
