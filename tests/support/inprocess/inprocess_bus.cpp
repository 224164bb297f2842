// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/inprocess/inprocess_bus.hpp"

#include <chrono>
#include <cstring>
#include <map>
#include <type_traits>
#include <utility>

#include "common/bus/backend.hpp"
#include "common/bus/bus_factory.hpp"
#include "common/bus/prefixed_calls.hpp"
#include "tests/support/inprocess/domain.hpp"

namespace rtd::bus::inprocess {
namespace {

std::shared_ptr<const void> copy_message(MessageId id, const void* message) {
  return visit_message_type(id, [message]<class T>() -> std::shared_ptr<const void> {
    return std::make_shared<const T>(*static_cast<const T*>(message));
  });
}

std::shared_ptr<void> allocate_plain(MessageId id) {
  return visit_message_type(id, []<class T>() -> std::shared_ptr<void> {
    if constexpr (std::is_trivially_copyable_v<T>) {
      return std::make_shared_for_overwrite<T>();
    } else {
      throw BusError("a message of variable size cannot be loaned");
    }
  });
}

class InprocessWriter : public WriterBackend {
 public:
  InprocessWriter(std::shared_ptr<Domain> domain, MessageId id, const std::string& topic, QosProfile profile,
                  StatusCallbacks callbacks, const WriterId& connection)
      : domain_(std::move(domain)),
        id_(id),
        endpoint_{{topic, dds_type_name(id), qos_settings(profile)},
                  StatusReporter(std::move(callbacks)),
                  domain_->new_id(connection)} {
    domain_->add(endpoint_);
  }
  ~InprocessWriter() override { domain_->remove(endpoint_); }

  bool write(const void* message) override {
    domain_->publish(endpoint_, copy_message(id_, message));
    return true;
  }
  void* loan() override {
    std::shared_ptr<void> slot = allocate_plain(id_);
    return loans_.emplace(slot.get(), slot).first->first;
  }
  bool write_loaned(void* slot) override {
    const auto node = loans_.extract(slot);
    if (node.empty()) return false;
    domain_->publish(endpoint_, node.mapped());
    return true;
  }
  void discard_loan(void* slot) override { loans_.erase(slot); }
  int matched() const override { return endpoint_.status.matched(); }
  bool wait_acknowledged(int) override { return true; }  // readers have a message when write() returns
  WriterId id() const override { return endpoint_.id; }

 private:
  std::shared_ptr<Domain> domain_;
  const MessageId id_;
  WriterEndpoint endpoint_;
  std::map<void*, std::shared_ptr<void>> loans_;
};

std::function<void(Message)> wanted_messages(ErasedCallback on_message, std::function<bool(const WriterId&)> accepts) {
  return [on_message = std::move(on_message), accepts = std::move(accepts)](Message message) {
    if (!accepts || accepts(message.writer)) on_message(std::move(message.content), message.writer);
  };
}

class InprocessReader : public ReaderBackend {
 public:
  InprocessReader(std::shared_ptr<Domain> domain, EndpointKind kind, ErasedCallback on_message,
                  StatusCallbacks callbacks)
      : domain_(std::move(domain)),
        endpoint_(std::move(kind), callbacks, wanted_messages(std::move(on_message), callbacks.accepts)) {
    domain_->add(endpoint_);
  }
  ~InprocessReader() override { domain_->remove(endpoint_); }
  int matched() const override { return endpoint_.status.matched(); }

 private:
  std::shared_ptr<Domain> domain_;
  ReaderEndpoint endpoint_;
};

std::int64_t realtime_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

class InprocessRawWriter : public RawWriter {
 public:
  InprocessRawWriter(std::shared_ptr<Domain> domain, const RawTopic& topic, RawQos qos) : domain_(std::move(domain)) {
    if (qos.depth <= 0) qos.depth = 10;
    const bool keeps_history = qos.durability != RawQos::Durability::kVolatile;
    endpoint_.kind = {topic.name, topic.type, {qos.depth, keeps_history}, qos.reliable};
    endpoint_.id = domain_->new_id();
    endpoint_.discovered = TopicWriter{endpoint_.id, topic, qos};
    domain_->add(endpoint_);
  }
  ~InprocessRawWriter() override { domain_->remove(endpoint_); }

  bool write(std::span<const std::byte> cdr, std::int64_t source_ns) override {
    auto block = std::make_shared<ByteBlock>();
    block->assign(cdr);
    const std::lock_guard lock(mutex_);
    const std::int64_t now_ns = realtime_ns();
    domain_->publish(endpoint_,
                     std::make_shared<const RawSample>(RawSample{
                         endpoint_.id, ++sequence_, source_ns == 0 ? now_ns : source_ns, now_ns, std::move(block)}));
    return true;
  }
  int matched() const override { return endpoint_.status.matched(); }
  bool wait_acknowledged(int) override { return true; }  // readers have a sample when write() returns

 private:
  std::shared_ptr<Domain> domain_;
  std::mutex mutex_;
  std::int64_t sequence_ = 0;
  WriterEndpoint endpoint_{{}, StatusReporter({})};
};

/// Raw endpoints meet raw endpoints, so calls are the same from a typed connection and from a raw one.
std::unique_ptr<CallEndpoint> create_calls_in(const std::shared_ptr<Domain>& domain, const CallTopics& topics,
                                              CallRole role, OnCall on_call) {
  const RawReaderOptions options = call_reader_options(role);
  const RawTopic received = received_topic(topics, role);
  std::uint64_t client = 0;
  const WriterId id = domain->new_id();
  std::memcpy(&client, id.data(), sizeof(client));
  return std::make_unique<PrefixedCalls>(
      role, client, std::make_unique<InprocessRawWriter>(domain, sent_topic(topics, role), call_writer_options().qos),
      [&](RawHandlers handlers) {
        return std::make_unique<InprocessReader>(domain, EndpointKind{received.name, received.type, {options.depth}},
                                                 raw_callback(std::move(handlers)), StatusCallbacks());
      },
      std::move(on_call));
}

class InprocessBackend : public BusBackend {
 public:
  explicit InprocessBackend(const BusOptions& options)
      : BusBackend(kInprocess),
        domain_(Domain::join(options.domain, Domain::Content::kTyped)),
        calls_(Domain::join(options.domain, Domain::Content::kRaw)),
        connection_(domain_->new_id()) {}

  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    return std::make_unique<InprocessWriter>(domain_, id, topic, profile, std::move(callbacks), connection_);
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    EndpointKind kind{topic, dds_type_name(id), qos_settings(profile)};
    return std::make_unique<InprocessReader>(domain_, std::move(kind), std::move(on_message), std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    return create_calls_in(calls_, topics, role, std::move(on_call));
  }

 private:
  std::shared_ptr<Domain> domain_, calls_;
  const WriterId connection_;
};

class InprocessRawBus : public RegistryRawBus {
 public:
  explicit InprocessRawBus(const BusOptions& options)
      : RegistryRawBus(kInprocess), domain_(Domain::join(options.domain, Domain::Content::kRaw)) {
    domain_->add(registry_);
  }
  ~InprocessRawBus() override { domain_->remove(registry_); }

  std::vector<TopicReader> readers() const override { return domain_->readers(); }

  std::unique_ptr<RawReader> make_reader(const RawTopic& topic, const RawReaderOptions& options,
                                         RawHandlers handlers) override {
    EndpointKind kind{topic.name, topic.type, {options.depth, options.transient_local}, options.reliable};
    return std::make_unique<InprocessReader>(domain_, std::move(kind), raw_callback(std::move(handlers)),
                                             StatusCallbacks());
  }
  std::unique_ptr<RawWriter> make_writer(const RawTopic& topic, const RawWriterOptions& options,
                                         StatusCallbacks) override {
    return std::make_unique<InprocessRawWriter>(domain_, topic, options.qos);
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    return create_calls_in(domain_, topics, role, std::move(on_call));
  }

 private:
  std::shared_ptr<Domain> domain_;
};

}  // namespace

std::shared_ptr<BusBackend> create_backend(const BusOptions& options) {
  return std::make_shared<InprocessBackend>(options);
}

std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options) {
  return std::make_shared<InprocessRawBus>(options);
}

std::string vendor() {
  static const bool added = (add_vendor({kInprocess, create_backend, create_raw_bus, false}), true);
  return added ? kInprocess : "";
}

std::vector<std::string> all_vendors() {
  vendor();
  return available_vendors();
}

}  // namespace rtd::bus::inprocess
