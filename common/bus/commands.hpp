// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/command_registry.hpp"

/// Commands to a running service, over DDS as ROS 2 services: `ros2 service call` and `rtd call` do the same.
namespace rtd::bus {

/// The type of the ROS 2 service.
enum class CommandKind {
  kTrigger,  ///< std_srvs/srv/Trigger
  kSetBool,  ///< std_srvs/srv/SetBool
  kText,     ///< rtd_msgs/srv/Command: string argument --- bool success, string message
};

/// "std_srvs/srv/Trigger", ...
std::string ros_type(CommandKind kind);

/// A longer request is refused.
inline constexpr std::size_t kMaxRequestBytes = 64 * 1024;

/// Offers commands while it lives, also to the process itself (Bus::commands()). What a handler throws, and a request
/// that cannot be read, becomes an answer without success. Requests wait in bounded queues (the oldest goes and gets no
/// answer), each with its own thread.
class CommandServer {
 public:
  using Handler = CommandHandler;

  explicit CommandServer(Bus& bus);
  /// With one command, as by offer_concurrent().
  CommandServer(Bus& bus, const std::string& name, CommandKind kind, Handler handler);
  /// Waits for running handlers; requests that still wait get no answer.
  ~CommandServer();
  CommandServer(const CommandServer&) = delete;
  CommandServer& operator=(const CommandServer&) = delete;

  /// The handler runs on the worker's thread, in serve(), and may touch all that the worker owns; the caller waits.
  /// `name`: "slam/reset", below the name of the bus's robot if it has one. By the worker. Throws BusError: refused.
  void offer(const std::string& name, CommandKind kind, Handler handler);
  /// For work that is long: the handler runs on a thread of the server, one call at a time, and may call run().
  void offer_concurrent(const std::string& name, CommandKind kind, Handler handler);
  /// Runs it on the worker's thread and waits. Not by the worker.
  CommandAnswer run(std::function<CommandAnswer()> work);
  /// Runs the handlers of the requests that wait. By the worker, often.
  void serve();
  /// Answers what waits for the worker, and what still comes, with "the service is ending".
  void close();

  /// Any ROS 2 service, by its bytes.
  struct Service {
    CallTopics topics;
    /// Gets the request in CDR, cut off behind kMaxRequestBytes, and returns the reply. Throws nothing.
    std::function<std::vector<std::byte>(std::span<const std::byte> request)> handler;
  };
  /// Their handlers run on one thread of the server. Throws BusError: refused.
  void offer_services(std::vector<Service> services);

 private:
  class Listener;

  Bus& bus_;
  std::mutex mutex_;
  bool closed_ = false;
  std::deque<std::packaged_task<CommandAnswer()>> tasks_;
  std::vector<std::unique_ptr<Listener>> listeners_;  // last: they use the others
};

/// A command that is offered in the domain now.
struct FoundCommand {
  std::string name;   ///< "slam/reset", without the robot
  std::string robot;  ///< "": of a robot without a name, or a service of another program
  CommandKind kind = CommandKind::kTrigger;
  std::string vendor;  ///< of the server: "fastdds", "cyclonedds", "inprocess"; "" for one that cannot be called
  int servers = 1;     ///< programs that offer it under this name

  /// As it is called: "/slam/reset", "/anna/slam/reset".
  std::string full_name() const;
};

/// The call brought no answer.
class CommandError : public BusError {
 public:
  enum class Cause { kNotFound, kSeveral, kWrongArgument, kNoAnswer };
  CommandError(Cause cause, const std::string& what) : BusError(what), cause_(cause) {}
  Cause cause() const { return cause_; }

 private:
  Cause cause_;
};

/// Finds and calls the commands of a domain. Uses its own connection, and one more for servers of another DDS
/// vendor once such a one is called: the RMWs of ROS 2 do not understand the services of each other. Thread-safe.
class CommandClient {
 public:
  /// Throws BusError as connect(). Discovery takes a moment: call() waits for it.
  explicit CommandClient(const BusOptions& options);
  ~CommandClient();
  CommandClient(const CommandClient&) = delete;
  CommandClient& operator=(const CommandClient&) = delete;

  /// By full name.
  std::vector<FoundCommand> commands() const;

  /// `name`: "slam/reset" or "/slam/reset"; with options.robot of that robot, else as it is ("anna/slam/reset").
  /// `argument`: as CommandRequest; "on", "off", "1" and "0" switch, too. Blocks until the answer is there.
  /// Throws CommandError: no such command, several servers of that name, an argument that it does not take, no answer
  /// within timeout_ms; BusError: refused.
  CommandAnswer call(const std::string& name, const std::string& argument, int timeout_ms);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace rtd::bus
