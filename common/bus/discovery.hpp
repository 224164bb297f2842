// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/callback_thread.hpp"
#include "common/bus/raw_bus.hpp"

/// What discovery finds in a domain, without a vendor.
namespace rtd::bus {

/// Finds endpoints of other participants that use the name of one of our topics with another type: DDS never matches
/// them, and reports nothing. Thread-safe.
class TopicTypes {
 public:
  /// Reports mismatches of one of our endpoints as long as it lives.
  class Watch {
   public:
    Watch(TopicTypes& types, const std::string& topic, const std::string& type, StatusReporter& status);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

   private:
    friend class TopicTypes;
    void compare(const std::string& other_type) const;
    TopicTypes& types_;
    const std::string topic_, type_;
    StatusReporter& status_;
  };

  /// An endpoint of another participant, by its id.
  void appeared(const std::string& endpoint, const std::string& topic, const std::string& type);
  void gone(const std::string& endpoint);

 private:
  struct Endpoint {
    std::string topic, type;
  };
  std::mutex mutex_;
  std::map<std::string, Endpoint> endpoints_;  ///< what appeared before the watch did counts too
  std::list<const Watch*> watches_;
};

/// The endpoints of a domain, as a vendor's discovery finds them. Discovery threads only take notes; the watcher of
/// writers has its own thread, so that it may create readers. Thread-safe.
class EndpointRegistry {
 public:
  std::vector<TopicWriter> writers() const;
  std::vector<TopicReader> readers() const;
  std::map<ParticipantId, std::string> participants() const;
  void watch(RawBus::Watcher watcher);

  void note(const TopicWriter& writer);
  void note(const TopicReader& reader);
  void note_gone(const WriterId& id);
  void note(const ParticipantId& participant, const std::string& name);
  void note_gone(const ParticipantId& participant);

 private:
  void report(const TopicWriter& writer, WriterChange change);

  mutable std::mutex mutex_;
  std::map<WriterId, TopicWriter> writers_;
  std::map<WriterId, TopicReader> readers_;
  std::map<ParticipantId, std::string> participants_;
  RawBus::Watcher watcher_;
  std::optional<CallbackThread> thread_;
};

/// A raw bus whose vendor notes the endpoints in a registry.
class RegistryRawBus : public RawBus {
 public:
  using RawBus::RawBus;
  std::vector<TopicWriter> writers() const override { return registry_.writers(); }
  std::vector<TopicReader> readers() const override { return registry_.readers(); }
  std::map<ParticipantId, std::string> participants() const override { return registry_.participants(); }
  void watch(Watcher watcher) override { registry_.watch(std::move(watcher)); }

 protected:
  EndpointRegistry registry_;
};

}  // namespace rtd::bus
