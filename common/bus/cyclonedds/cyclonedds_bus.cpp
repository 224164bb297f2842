// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/vendors.hpp"

#include <utility>

#include "common/bus/cyclonedds/endpoints.hpp"
#include "common/bus/cyclonedds/qos_mapping.hpp"
#include "common/bus/cyclonedds/samples.hpp"
#include "common/bus/prefixed_calls.hpp"
#include "common/bus/ros_graph.hpp"

namespace rtd::bus::cyclonedds {
namespace {

CycloneReader::Handlers typed_handlers(MessageId id, ErasedCallback on_message, StatusCallbacks callbacks) {
  CycloneReader::Handlers handlers;
  handlers.on_sample = [id, on_message = std::move(on_message),
                        accepts = callbacks.accepts](const TakenSample& sample) {
    if (accepts && !accepts(sample.origin.writer)) return true;
    std::shared_ptr<const void> message = decode(id, sample.bytes);
    if (message == nullptr) return false;
    on_message(std::move(message), sample.origin.writer);
    return true;
  };
  handlers.status = std::move(callbacks);
  return handlers;
}

SampleType raw_type(const RawTopic& topic, const RawReaderOptions& options = {}) {
  const std::size_t largest = options.largest_sample > 0 ? options.largest_sample : largest_sample(topic);
  return {topic.type, topic.keyed, 0, true, largest};
}

CycloneReader::Handlers raw_handlers(const RawHandlers& handlers) {
  CycloneReader::Handlers own;
  own.on_sample = [on_sample = handlers.on_sample](const TakenSample& taken) {
    if (!on_sample) return true;
    on_sample({taken.origin.writer, taken.origin.sequence, taken.source_ns, taken.received_ns, taken.bytes});
    return true;
  };
  own.on_gap = handlers.on_lost;
  own.status = handlers.status;
  return own;
}

class RawCycloneWriter : public RawWriter {
 public:
  RawCycloneWriter(std::shared_ptr<Participant> participant, const RawTopic& topic, const RawWriterOptions& options,
                   StatusCallbacks callbacks)
      : fixed_bytes_(options.fixed_bytes),
        writer_(std::move(participant), raw_type(topic), topic.name, writer_qos(options.qos), std::move(callbacks)) {}
  bool write(std::span<const std::byte> cdr, std::int64_t source_ns) override {
    const bool right_size = fixed_bytes_ == 0 || cdr.size() == fixed_bytes_;
    if (cdr.size() < ByteBlock::kCdrHeaderBytes || !right_size) return false;
    auto block = acquire_block(writer_.type(), cdr.size());
    block->assign(cdr);
    return writer_.write(std::move(block), source_ns);
  }
  /// A number that no other entity of the domain has, as rmw_cyclonedds uses it for a client.
  std::uint64_t instance() const {
    dds_instance_handle_t handle = 0;
    dds_get_instance_handle(writer_.handle(), &handle);
    return handle;
  }
  int matched() const override { return writer_.matched(); }
  bool wait_acknowledged(int timeout_ms) override { return writer_.wait_acknowledged(timeout_ms); }

 private:
  const std::uint32_t fixed_bytes_;
  CycloneWriter writer_;
};

std::unique_ptr<CallEndpoint> create_calls_on(const std::shared_ptr<Participant>& participant, const CallTopics& topics,
                                              CallRole role, OnCall on_call) {
  auto writer = std::make_unique<RawCycloneWriter>(participant, sent_topic(topics, role), call_writer_options(),
                                                   StatusCallbacks());
  const std::uint64_t client = writer->instance();
  const RawTopic received = received_topic(topics, role);
  return std::make_unique<PrefixedCalls>(
      role, client, std::move(writer),
      [&](const RawHandlers& handlers) {
        const RawReaderOptions options = call_reader_options(role);
        return std::make_unique<CycloneReader>(participant, raw_type(received, options), received.name,
                                               raw_reader_qos(options), raw_handlers(handlers));
      },
      std::move(on_call));
}

NodeAnnouncer::CreateWriter writers_of(const std::shared_ptr<Participant>& participant) {
  return [participant](const RawTopic& topic, const RawWriterOptions& options) {
    return std::make_unique<RawCycloneWriter>(participant, topic, options, StatusCallbacks());
  };
}

class CycloneBackend : public BusBackend {
 public:
  CycloneBackend(const BusOptions& options, std::shared_ptr<NodeEndpoints> node)
      : BusBackend("cyclonedds"),
        participant_(std::make_shared<Participant>(options, std::move(node))),
        announcer_(participant_->node_endpoints(), participant_->id(), options, writers_of(participant_)) {}

  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    Qos qos = writer_qos(to_raw_qos(qos_settings(profile)));
    return std::make_unique<TypedWriter>(participant_, id, topic, std::move(qos), std::move(callbacks));
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    Qos qos = reader_qos(to_raw_qos(qos_settings(profile)));
    return std::make_unique<CycloneReader>(participant_, sample_type(id), topic, std::move(qos),
                                           typed_handlers(id, std::move(on_message), std::move(callbacks)));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    return create_calls_on(participant_, topics, role, std::move(on_call));
  }

 private:
  std::shared_ptr<Participant> participant_;
  NodeAnnouncer announcer_;
};

/// RTPS: the low bits of an entity's last byte distinguish an endpoint with key from one without.
bool is_keyed(const WriterId& id) {
  const int kind = id.back() & 0x0f;
  return kind == 0x02 || kind == 0x07;
}

class CycloneRawBus : public RegistryRawBus {
 public:
  explicit CycloneRawBus(const BusOptions& options)
      : RegistryRawBus("cyclonedds"),
        participant_(std::make_shared<Participant>(options)),
        announcer_(participant_->node_endpoints(), participant_->id(), options, writers_of(participant_)),
        writers_(participant_->handle(), EndpointWatch::Direction::kWriters,
                 [this](const WriterId& id, const dds_builtintopic_endpoint_t* writer) { note_writer(id, writer); }),
        readers_(participant_->handle(), EndpointWatch::Direction::kReaders,
                 [this](const WriterId& id, const dds_builtintopic_endpoint_t* reader) { note_reader(id, reader); }) {}

  std::map<ParticipantId, std::string> participants() const override { return participant_->participants(); }

  std::unique_ptr<RawReader> make_reader(const RawTopic& topic, const RawReaderOptions& options,
                                         RawHandlers handlers) override {
    return std::make_unique<CycloneReader>(participant_, raw_type(topic, options), topic.name, raw_reader_qos(options),
                                           raw_handlers(handlers));
  }
  std::unique_ptr<RawWriter> make_writer(const RawTopic& topic, const RawWriterOptions& options,
                                         StatusCallbacks callbacks) override {
    return std::make_unique<RawCycloneWriter>(participant_, topic, options, std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    return create_calls_on(participant_, topics, role, std::move(on_call));
  }

 private:
  void note_writer(const WriterId& id, const dds_builtintopic_endpoint_t* endpoint) {
    if (endpoint == nullptr) return registry_.note_gone(id);
    TopicWriter writer;
    writer.id = id;
    writer.topic = {endpoint->topic_name, endpoint->type_name, is_keyed(id)};
    writer.qos = from_vendor(*endpoint->qos);
    writer.user_data = user_data(*endpoint->qos);
    writer.own = participant_->is_own(id);
    registry_.note(writer);
  }
  void note_reader(const WriterId& id, const dds_builtintopic_endpoint_t* endpoint) {
    if (endpoint == nullptr) return registry_.note_gone(id);
    const RawTopic topic{endpoint->topic_name, endpoint->type_name, is_keyed(id)};
    registry_.note(TopicReader{id, topic, participant_->is_own(id), user_data(*endpoint->qos)});
  }

  std::shared_ptr<Participant> participant_;
  NodeAnnouncer announcer_;
  EndpointWatch writers_, readers_;  // last: they use the others
};

}  // namespace

std::shared_ptr<BusBackend> create_backend(const BusOptions& options, std::shared_ptr<NodeEndpoints> node) {
  return std::make_shared<CycloneBackend>(options, std::move(node));
}

std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options) {
  return std::make_shared<CycloneRawBus>(options);
}

}  // namespace rtd::bus::cyclonedds
