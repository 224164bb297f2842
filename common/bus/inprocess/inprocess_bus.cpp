// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/inprocess/inprocess_backend.hpp"

#include <map>
#include <optional>
#include <type_traits>
#include <utility>

#include "common/bus/inprocess/domain.hpp"
#include "common/bus/message_visit.hpp"

namespace rtd::bus::inprocess {
namespace {

Message copy_message(MessageId id, const void* message) {
  return visit_message_type(
      id, [message]<class T>() -> Message { return std::make_shared<const T>(*static_cast<const T*>(message)); });
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

bool wants_events(const StatusCallbacks& callbacks) {
  return callbacks.on_matched || callbacks.on_incompatible_qos;
}

class InprocessWriter : public WriterBackend {
 public:
  InprocessWriter(std::shared_ptr<Domain> domain, MessageId id, const std::string& topic, QosProfile profile,
                  StatusCallbacks callbacks)
      : domain_(std::move(domain)), endpoint_{{id, topic, qos_settings(profile), std::move(callbacks)}} {
    if (wants_events(endpoint_.callbacks)) endpoint_.thread = &thread_.emplace();
    domain_->add(endpoint_);
  }
  ~InprocessWriter() override { domain_->remove(endpoint_); }

  bool write(const void* message) override {
    domain_->publish(endpoint_, copy_message(endpoint_.type, message));
    return true;
  }
  void* loan() override {
    std::shared_ptr<void> slot = allocate_plain(endpoint_.type);
    return loans_.emplace(slot.get(), slot).first->first;
  }
  bool write_loaned(void* slot) override {
    const auto node = loans_.extract(slot);
    if (node.empty()) return false;
    domain_->publish(endpoint_, node.mapped());
    return true;
  }
  void discard_loan(void* slot) override { loans_.erase(slot); }
  int matched() const override { return endpoint_.matched; }
  bool wait_acknowledged(int) override { return true; }  // a message is with its readers when write() returns

 private:
  std::shared_ptr<Domain> domain_;
  WriterEndpoint endpoint_;
  std::optional<CallbackThread> thread_;
  std::map<void*, std::shared_ptr<void>> loans_;
};

class InprocessReader : public ReaderBackend {
 public:
  InprocessReader(std::shared_ptr<Domain> domain, MessageId id, const std::string& topic, QosProfile profile,
                  ErasedCallback on_message, StatusCallbacks callbacks)
      : domain_(std::move(domain)),
        endpoint_{{id, topic, qos_settings(profile), std::move(callbacks)}},
        mailbox_(static_cast<std::size_t>(endpoint_.qos.depth), std::move(on_message)) {
    endpoint_.thread = &mailbox_.thread();
    endpoint_.mailbox = &mailbox_;
    domain_->add(endpoint_);
  }
  ~InprocessReader() override { domain_->remove(endpoint_); }
  int matched() const override { return endpoint_.matched; }

 private:
  std::shared_ptr<Domain> domain_;
  ReaderEndpoint endpoint_;
  Mailbox mailbox_;  // after endpoint_: its thread uses the endpoint's callbacks and ends first
};

class InprocessBackend : public BusBackend {
 public:
  explicit InprocessBackend(std::uint32_t domain) : domain_(Domain::join(domain)) {}

  const std::string& vendor() const override { return vendor_; }
  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    return std::make_unique<InprocessWriter>(domain_, id, topic, profile, std::move(callbacks));
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    return std::make_unique<InprocessReader>(domain_, id, topic, profile, std::move(on_message), std::move(callbacks));
  }

 private:
  const std::string vendor_ = "inprocess";
  std::shared_ptr<Domain> domain_;
};

}  // namespace

std::shared_ptr<BusBackend> create_backend(std::uint32_t domain) {
  return std::make_shared<InprocessBackend>(domain);
}

}  // namespace rtd::bus::inprocess
