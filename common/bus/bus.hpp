// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>

#include "common/bus/backend.hpp"
#include "common/bus/command_registry.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topics.hpp"
#include "common/bus/traffic.hpp"

namespace rtd::bus {

/// A message slot borrowed from the writer. Fill it through `->`, then give it to Writer::write(Loan&&).
/// Not written: returned to the writer on destruction. Move only; not thread-safe.
template <class T>
class Loan {
 public:
  Loan(WriterBackend* writer, void* slot) : writer_(writer), slot_(static_cast<T*>(slot)) {}
  Loan(Loan&& other) noexcept : writer_(other.writer_), slot_(std::exchange(other.slot_, nullptr)) {}
  Loan& operator=(Loan&&) = delete;
  ~Loan() {
    if (slot_ != nullptr) writer_->discard_loan(slot_);
  }
  T* operator->() { return slot_; }
  T& operator*() { return *slot_; }

 private:
  template <class U>
  friend class Writer;
  T* release() { return std::exchange(slot_, nullptr); }
  WriterBackend* writer_;
  T* slot_;
};

/// Publishes T on one topic. write() is thread-safe; loan() + write(Loan) belong to one thread.
template <class T>
class Writer {
 public:
  Writer() = default;
  Writer(std::unique_ptr<WriterBackend> backend, Traffic::Sent sent)
      : backend_(std::move(backend)), sent_(std::move(sent)) {}
  explicit operator bool() const { return backend_ != nullptr; }

  /// Hands the message to the bus. False when the bus could not take it (history full past the blocking time, shut
  /// down).
  bool write(const T& message) { return counted(backend_->write(&message)); }
  /// A slot to build a fixed-size message in place. Its content is undefined until filled: fill every field.
  Loan<T> loan() requires MessageTraits<T>::kPlain { return Loan<T>(backend_.get(), backend_->loan()); }
  bool write(Loan<T>&& loan) { return counted(backend_->write_loaned(loan.release())); }
  /// Number of readers matched now. Each side matches on its own: on a volatile topic, what is written before the
  /// reader too has matched may never reach it, so wait for the other side's heartbeat where the first
  /// message matters.
  int matched() const { return backend_->matched(); }
  /// Blocks until every reliable reader has acknowledged what was written, at most timeout_ms. True when all did.
  bool wait_acknowledged(int timeout_ms) { return backend_->wait_acknowledged(timeout_ms); }
  /// What readers get as the source of its messages.
  WriterId id() const { return backend_->id(); }

 private:
  bool counted(bool written) {
    if (written) ++*sent_;
    return written;
  }

  std::unique_ptr<WriterBackend> backend_;
  Traffic::Sent sent_;
};

/// Receives T from one topic until destroyed. The callback runs on a bus thread, one call at a time per reader: push to
/// a queue and return. Messages are immutable and may be kept. Frames are copied out of shared memory and checked for
/// having been overwritten meanwhile before the callback sees them, so no torn frame is ever delivered. Messages whose
/// content no honest program sends are counted (Bus::troubles()) and never delivered, whatever the backend.
/// After the destructor returns, no callback runs.
template <class T>
class Reader {
 public:
  Reader() = default;
  explicit Reader(std::unique_ptr<ReaderBackend> backend) : backend_(std::move(backend)) {}
  explicit operator bool() const { return backend_ != nullptr; }
  int matched() const { return backend_->matched(); }

 private:
  std::unique_ptr<ReaderBackend> backend_;
};

/// What went wrong on one topic since the connection began.
struct TopicTrouble {
  std::uint64_t lost = 0;              ///< samples that never came, or were overwritten before they were taken
  std::uint64_t rejected = 0;          ///< samples that did not fit into the history
  std::uint64_t incompatible_qos = 0;  ///< peers refused for their QoS
  std::uint64_t type_mismatch = 0;     ///< peers that use the name with another type
  std::string policy;                  ///< of the last peer refused, e.g. "RELIABILITY"
  std::string other_type;              ///< of the last mismatch
  std::uint64_t implausible = 0;       ///< messages refused for their content (common/msg/plausible.hpp)
  std::string implausible_field;       ///< of the last message refused, e.g. "rtd_msgs/Feature.octave"
  std::uint64_t too_large = 0;         ///< own messages that were not sent (common/msg/largest_sample.hpp)
  friend bool operator==(const TopicTrouble&, const TopicTrouble&) = default;
};

/// Counts for each topic of one connection what its endpoints report. Thread-safe.
class TopicCounters {
 public:
  /// The callbacks of one endpoint, counted before they are called.
  StatusCallbacks count(const std::string& topic, StatusCallbacks callbacks);
  /// The edge of the bus: hands on what is plausible and counts the rest.
  ErasedCallback screen(MessageId id, const std::string& topic, ErasedCallback on_message);
  /// Topics with trouble, by name.
  std::map<std::string, TopicTrouble> troubles() const;

 private:
  struct Book {
    mutable std::mutex mutex;
    std::map<std::string, TopicTrouble> troubles;
  };
  std::shared_ptr<Book> book_ = std::make_shared<Book>();  ///< endpoints may report until they end
};

/// One connection of a process to the topics of a domain. Writers and readers must not outlive it.
/// Throws BusError with cause and fix when the backend cannot start. Thread-safe.
class Bus {
 public:
  explicit Bus(std::shared_ptr<BusBackend> backend, std::string robot = {},
               std::shared_ptr<Traffic> traffic = std::make_shared<Traffic>())
      : traffic_(std::move(traffic)), backend_(std::move(backend)), robot_(std::move(robot)) {}

  template <class T>
  Writer<T> writer(const Topic<T>& topic, StatusCallbacks callbacks = {}) {
    const std::string name = topic_of_robot(topic.name, robot_);
    return Writer<T>(backend_->create_writer(MessageTraits<T>::kId, name, topic.profile,
                                             counters_.count(name, std::move(callbacks))),
                     traffic_->output(name));
  }

  /// `on_message` takes the message, a shared_ptr<const T>, and if it wants to the WriterId of its source.
  template <class T, class OnMessage>
  Reader<T> reader(const Topic<T>& topic, OnMessage on_message, StatusCallbacks callbacks = {}) {
    auto erased = [on_message = std::move(on_message)](std::shared_ptr<const void> message,
                                                       const WriterId& writer) mutable {
      auto typed = std::static_pointer_cast<const T>(std::move(message));
      if constexpr (std::is_invocable_v<OnMessage&, std::shared_ptr<const T>, const WriterId&>) {
        on_message(std::move(typed), writer);
      } else {
        on_message(std::move(typed));
      }
    };
    const std::string name = topic_of_robot(topic.name, robot_);
    constexpr MessageId kId = MessageTraits<T>::kId;
    const std::shared_ptr<Input> input = traffic_->input(name, static_cast<bool>(callbacks.accepts));
    return Reader<T>(backend_->create_reader(kId, name, topic.profile,
                                             input->counting(counters_.screen(kId, name, std::move(erased))),
                                             input->counting(counters_.count(name, std::move(callbacks)))));
  }

  /// One end of a ROS 2 service by its names on the wire (common/bus/commands.hpp offers and calls them).
  std::unique_ptr<CallEndpoint> calls(const CallTopics& topics, CallRole role, OnCall on_call) {
    return backend_->create_calls(topics, role, std::move(on_call));
  }

  /// What CommandServers on this connection offer.
  const std::shared_ptr<CommandRegistry>& commands() const { return commands_; }

  const std::string& vendor() const { return backend_->vendor(); }
  /// Whose topics writers and readers get; "" for a robot without a name.
  const std::string& robot() const { return robot_; }
  /// A tf frame of this robot.
  std::string frame(const std::string& name) const { return frame_of_robot(name, robot_); }
  /// The same connection for the topics of another robot. Counts its troubles for itself.
  std::shared_ptr<Bus> of_robot(const std::string& robot) const {
    return std::make_shared<Bus>(backend_, robot, traffic_);
  }
  /// Topics on which samples were lost or rejected or peers or messages refused since the connection began.
  std::map<std::string, TopicTrouble> troubles() const { return counters_.troubles(); }
  /// What the writers and readers of this connection have sent and received, for all robots.
  const Traffic& traffic() const { return *traffic_; }

 private:
  TopicCounters counters_;
  const std::shared_ptr<Traffic> traffic_;
  std::shared_ptr<BusBackend> backend_;
  const std::shared_ptr<CommandRegistry> commands_ = std::make_shared<CommandRegistry>();
  const std::string robot_;
};

}  // namespace rtd::bus
