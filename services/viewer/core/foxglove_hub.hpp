// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "services/viewer/core/access.hpp"
#include "services/viewer/core/command_forms.hpp"
#include "services/viewer/core/foxglove.hpp"

namespace rtd::viewer {

/// A recording that is being played: where it was at a moment, and how it continues from there.
struct Played {
  std::uint64_t begin_ns = 0, end_ns = 0;  ///< recorded times of its first and last message
  std::uint64_t position_ns = 0;           ///< recorded time
  double speed = 1;                        ///< 0: as fast as possible
  bool paused = false, ended = false;
  std::int64_t at_ns = 0;  ///< CLOCK_REALTIME at which it was there

  std::uint64_t position_at(std::int64_t realtime_ns) const;
  float shown_speed() const { return speed > 0 ? static_cast<float>(speed) : 1.0F; }
};

/// What Foxglove clients cause outside. All are called by the hub's thread; empty ones are not offered.
struct FoxgloveHooks {
  /// A channel got its first subscriber, or lost its last.
  std::function<void(std::uint32_t channel, bool wanted)> on_wanted;
  /// Calls a command. `answer` may be called later, by the hub's thread.
  std::function<void(const CommandInfo&, const std::string& argument, std::function<void(CommandResult)> answer)>
      on_call;
  /// Sets a parameter. `answer` as above; the message says why not.
  std::function<void(const foxglove::Parameter&, std::function<void(CommandResult)> answer)> on_set;
  /// Pauses, seeks, changes the speed. `answer` as above.
  std::function<void(const foxglove::PlaybackControl&, std::function<void(CommandResult)> answer)> on_playback;
  /// A client publishes a message; returns why not, or "".
  std::function<std::string(const std::string& topic, const std::string& schema, std::span<const std::byte> cdr)>
      on_publish;
  std::function<std::int64_t()> realtime_ns = [] { return std::int64_t{0}; };  ///< CLOCK_REALTIME
};

class FoxgloveSession;

/// What all Foxglove clients see: channels, services, parameters, the connection graph, and the messages of subscribed
/// channels. One thread.
class FoxgloveHub {
 public:
  FoxgloveHub(std::string name, std::string session_id, std::map<std::string, std::string> metadata,
              FoxgloveHooks hooks);

  /// A client joins. The hub outlives it. `subprotocol`: one of kSubprotocols.
  std::unique_ptr<Session> open(std::string_view subprotocol = foxglove::kSubprotocols[0],
                                Rights rights = Rights::kControl);

  /// The id of the channel; the same topic and type get the same id again.
  std::uint32_t add_channel(const std::string& topic, const foxglove::Schema& schema);
  void remove_channel(std::uint32_t id);
  bool wanted(std::uint32_t channel) const;
  /// `source_ns`: when it was published. While a recording is played clients see recorded times, so what is published
  /// now gets the time of the playhead; what is played has its own.
  void publish(std::uint32_t channel, std::int64_t source_ns, std::shared_ptr<const Bytes> payload);

  void set_commands(const std::vector<CommandInfo>& commands);
  void set_parameters(std::vector<foxglove::Parameter> parameters);
  void set_graph(foxglove::ConnectionGraph graph);
  /// A recording is played, or none (any more). Clients that are there already get the server's description again, with
  /// playback control and in the same session: they keep what they have. News older than known ones are ignored.
  void set_played(const std::optional<Played>& played);
  const std::optional<Played>& played() const { return played_; }
  /// A client's request was carried out.
  void control_done(const foxglove::PlaybackControl& request);
  /// To all clients; `answered`: the request that led to it.
  void send_playback(const foxglove::PlaybackControl* answered = nullptr);
  /// The time of the playhead while a recording is played.
  void send_time();

  std::size_t clients() const { return sessions_.size(); }
  std::uint64_t dropped() const;

 private:
  friend class FoxgloveSession;
  struct Offer {
    foxglove::Channel channel;
    bool offered = true;
  };

  const FoxgloveHooks& hooks_of(Rights rights) const { return rights == Rights::kControl ? hooks_ : looking_; }
  foxglove::ServerInfo server_info(const FoxgloveHooks& hooks) const;
  std::vector<foxglove::Channel> channels() const;
  std::vector<foxglove::Parameter> parameters(const std::vector<std::string>& names) const;
  void broadcast(const std::string& text);
  void update_wanted(std::uint32_t channel);
  void remove(FoxgloveSession* session);

  const std::string name_, session_id_;
  const std::map<std::string, std::string> metadata_;
  const FoxgloveHooks hooks_, looking_;  ///< looking_: of clients that cause nothing
  std::set<FoxgloveSession*> sessions_;
  std::map<std::uint32_t, Offer> channels_;
  std::set<std::uint32_t> wanted_;
  std::map<std::string, std::uint32_t> service_ids_;  ///< also of those that are gone
  std::map<std::uint32_t, std::pair<CommandInfo, foxglove::Service>> services_;
  std::vector<foxglove::Parameter> parameters_;
  foxglove::ConnectionGraph graph_;
  std::optional<Played> played_;
};

/// One Foxglove client.
class FoxgloveSession : public Session {
 public:
  FoxgloveSession(FoxgloveHub& hub, std::string_view subprotocol, Rights rights);
  ~FoxgloveSession() override;
  FoxgloveSession(const FoxgloveSession&) = delete;
  FoxgloveSession& operator=(const FoxgloveSession&) = delete;

  void on_text(std::string_view text) override;
  void on_binary(std::span<const std::byte> bytes) override;
  std::optional<Frame> next(std::int64_t) override { return outbox_.pop(); }
  bool overflowed() const override { return outbox_.overflowed(); }

 private:
  friend class FoxgloveHub;
  static constexpr std::size_t kMaxSubscriptions = 4096;

  void handle(const std::function<foxglove::Request()>& read);
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
  void answer_parameters(const std::vector<foxglove::Parameter>& accepted, const foxglove::SetParameters& request);

  void send(const std::string& text) { outbox_.push_control(text_frame(text)); }
  void warn(const std::string& message) { send(foxglove::status(foxglove::StatusLevel::kWarning, message)); }
  void send_error(const std::string& message) { send(foxglove::status(foxglove::StatusLevel::kError, message)); }
  bool subscribes(std::uint32_t channel) const;
  void deliver(std::uint32_t channel, std::uint64_t log_time_ns, const std::shared_ptr<const Bytes>& payload);
  bool watches(const std::string& parameter) const;

  FoxgloveHub& hub_;
  const FoxgloveHooks& hooks_;  ///< of the hub, for this client's rights
  Outbox outbox_;
  bool knows_playback_;  ///< clients of foxglove.websocket.v1 take the state of playback for an error
  std::map<std::uint32_t, std::uint32_t> subscriptions_;  ///< channel by the client's id
  std::map<std::uint32_t, foxglove::Channel> published_;  ///< by the client, by its id
  bool watches_all_parameters_ = false, watches_graph_ = false;
  std::set<std::string> watched_parameters_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< answers may come when this is gone
};

}  // namespace rtd::viewer
