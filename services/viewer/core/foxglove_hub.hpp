// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "services/viewer/core/command_forms.hpp"
#include "services/viewer/core/foxglove.hpp"
#include "services/viewer/core/session.hpp"

namespace rtd::viewer {

/// What Foxglove clients cause outside. All are called by the hub's thread; empty ones are not offered.
struct FoxgloveHooks {
  /// A channel got its first subscriber, or lost its last.
  std::function<void(std::uint32_t channel, bool wanted)> on_wanted;
  /// Calls a command. `answer` may be called later, by the hub's thread.
  std::function<void(const CommandInfo&, const std::string& argument, std::function<void(CommandResult)> answer)>
      on_call;
  /// Sets a parameter; returns why not, or "".
  std::function<std::string(const foxglove::Parameter&)> on_set;
  std::function<void(const foxglove::PlaybackControl&)> on_playback;
  /// A client publishes a message; returns why not, or "".
  std::function<std::string(const std::string& topic, const std::string& schema, std::span<const std::byte> cdr)>
      on_publish;
};

class FoxgloveSession;

/// What all Foxglove clients see: channels, services, parameters, the connection graph, and the messages of subscribed
/// channels. One thread.
class FoxgloveHub {
 public:
  FoxgloveHub(std::string name, std::string session_id, std::map<std::string, std::string> metadata,
              FoxgloveHooks hooks);

  /// A client joins. The hub outlives it.
  std::unique_ptr<Session> open();

  /// The id of the channel; the same topic and type get the same id again.
  std::uint32_t add_channel(const std::string& topic, const foxglove::Schema& schema);
  void remove_channel(std::uint32_t id);
  bool wanted(std::uint32_t channel) const;
  void publish(std::uint32_t channel, std::uint64_t log_time_ns, std::shared_ptr<const Bytes> payload);

  void set_commands(const std::vector<CommandInfo>& commands);
  void set_parameters(std::vector<foxglove::Parameter> parameters);
  void set_graph(foxglove::ConnectionGraph graph);
  /// Something is played: its begin and end, ns. Clients that are there already get the server's description again,
  /// with playback control and in the same session: they keep what they have.
  void set_played(std::uint64_t begin_ns, std::uint64_t end_ns);
  void set_playback(const foxglove::PlaybackState& state);
  void send_time(std::uint64_t now_ns);

  std::size_t clients() const { return sessions_.size(); }
  std::uint64_t dropped() const;

 private:
  friend class FoxgloveSession;
  struct Offer {
    foxglove::Channel channel;
    bool offered = true;
  };

  foxglove::ServerInfo server_info() const;
  std::vector<foxglove::Channel> channels() const;
  const foxglove::Service* service(std::uint32_t id) const;
  std::vector<foxglove::Parameter> parameters(const std::vector<std::string>& names) const;
  void broadcast(const std::string& text);
  void update_wanted(std::uint32_t channel);
  void remove(FoxgloveSession* session);

  const std::string name_, session_id_;
  const std::map<std::string, std::string> metadata_;
  const FoxgloveHooks hooks_;
  std::set<FoxgloveSession*> sessions_;
  std::map<std::uint32_t, Offer> channels_;
  std::set<std::uint32_t> wanted_;
  std::map<std::string, std::uint32_t> service_ids_;  ///< also of those that are gone
  std::map<std::uint32_t, std::pair<CommandInfo, foxglove::Service>> services_;
  std::vector<foxglove::Parameter> parameters_;
  foxglove::ConnectionGraph graph_;
  std::optional<std::pair<std::uint64_t, std::uint64_t>> played_ns_;
};

/// One Foxglove client.
class FoxgloveSession : public Session {
 public:
  explicit FoxgloveSession(FoxgloveHub& hub);
  ~FoxgloveSession() override;
  FoxgloveSession(const FoxgloveSession&) = delete;
  FoxgloveSession& operator=(const FoxgloveSession&) = delete;

  void on_text(std::string_view text) override;
  void on_binary(std::span<const std::byte> bytes) override;
  std::optional<Frame> next(std::int64_t) override { return outbox_.pop(); }
  bool overflowed() const override { return outbox_.overflowed(); }

 private:
  friend class FoxgloveHub;
  static constexpr std::size_t kMostSubscriptions = 4096;

  void handle(const foxglove::Request& request);
  void answer(const foxglove::Subscribe& request);
  void answer(const foxglove::Unsubscribe& request);
  void answer(const foxglove::ClientAdvertise& request);
  void answer(const foxglove::ClientUnadvertise& request);
  void answer(const foxglove::GetParameters& request);
  void answer(const foxglove::SetParameters& request);
  void answer(const foxglove::WatchParameters& request);
  void answer(const foxglove::WatchGraph& request);
  void answer(const foxglove::FetchAsset& request);
  void answer(const foxglove::ClientMessage& request);
  void answer(const foxglove::ServiceCall& request);
  void answer(const foxglove::PlaybackControl& request);

  void send(const std::string& text) { outbox_.push_control(text_frame(text)); }
  void warn(const std::string& message) { send(foxglove::status(foxglove::StatusLevel::kWarning, message)); }
  void send_error(const std::string& message) { send(foxglove::status(foxglove::StatusLevel::kError, message)); }
  bool subscribes(std::uint32_t channel) const;
  void deliver(std::uint32_t channel, std::uint64_t log_time_ns, const std::shared_ptr<const Bytes>& payload);
  bool watches(const std::string& parameter) const;

  FoxgloveHub& hub_;
  Outbox outbox_;
  std::map<std::uint32_t, std::uint32_t> subscriptions_;  ///< channel by the client's id
  std::map<std::uint32_t, foxglove::Channel> published_;  ///< by the client, by its id
  bool watches_all_parameters_ = false, watches_graph_ = false;
  std::set<std::string> watched_parameters_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< answers may come when this is gone
};

}  // namespace rtd::viewer
