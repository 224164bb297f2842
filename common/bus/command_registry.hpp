// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace rtd::bus {

/// What the caller of a command asks for.
struct CommandRequest {
  std::string argument;  ///< "" for a trigger, "true" or "false" for a switch, any text for kText
};

struct CommandAnswer {
  bool success = false;
  std::string message;  ///< what happened, or cause and fix
};

using CommandHandler = std::function<CommandAnswer(const CommandRequest&)>;

/// The commands that a connection offers, for calls from within the process. Thread-safe.
class CommandRegistry {
 public:
  void add(const std::string& name, CommandHandler handler);
  /// Waits for a running call.
  void remove(const std::string& name);
  /// Runs the handler, as a request from outside does; nothing when the command is not offered. What the handler throws
  /// becomes an answer without success.
  std::optional<CommandAnswer> call(const std::string& name, const CommandRequest& request);

 private:
  struct Entry {
    std::mutex mutex;  ///< held while the handler runs
    CommandHandler handler;
  };
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Entry>> entries_;
};

}  // namespace rtd::bus
