// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <string>

namespace rtd::bus {

/// Finds endpoints of others that use the name of one of our topics with another type: DDS never matches them, and
/// says nothing. Thread-safe.
class TopicTypes {
 public:
  /// Runs with the foreign type's name, under a lock: only post it.
  using OnMismatch = std::function<void(const std::string& type)>;

  /// Tells of a mismatch as long as it lives.
  class Watch {
   public:
    Watch(TopicTypes& types, const std::string& topic, const std::string& type, OnMismatch on_mismatch);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

   private:
    friend class TopicTypes;
    void compare(const std::string& foreign_type) const;
    TopicTypes& types_;
    const std::string topic_, type_;
    const OnMismatch on_mismatch_;
  };

  /// An endpoint of somebody else, by its id.
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

}  // namespace rtd::bus
