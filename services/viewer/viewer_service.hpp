// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "services/viewer/command_queue.hpp"
#include "services/viewer/core/foxglove_hub.hpp"
#include "services/viewer/core/metrics_text.hpp"
#include "services/viewer/core/page_hub.hpp"
#include "services/viewer/robot_feed.hpp"
#include "services/viewer/topic_feed.hpp"
#include "services/viewer/web/site.hpp"
#include "services/viewer/web/web_server.hpp"

namespace CLI {
class App;
}

namespace rtd::viewer {

/// Section `viewer` of the configuration.
struct ServiceConfig {
  std::string bind_address = "127.0.0.1";
  int port = 8765;
  std::string token;
  std::vector<std::string> hosts;
  std::vector<std::string> origins{"https://app.foxglove.dev", "https://studio.foxglove.dev", "file://"};
  std::vector<std::string> topics{"*"};
  bool read_only = false;
  bool publish = false;
  bool open = false;
  double max_kbps = 1000;
  double image_hz = 10;

  void bind(auto& binder) {
    binder.field("bind", bind_address, "address to listen on; 0.0.0.0: all interfaces, with a token").option("--bind");
    binder.field("port", port, {0, 65535}, "port; 0: any free one").option("--port");
    binder
        .field("token", token,
               "asked of every client; empty: one is made up, and on loopback it is asked only for commands")
        .option("--token");
    binder.field("hosts", hosts, "further names by which browsers may address this host").option("--host");
    binder.field("origins", origins, "sites whose pages may connect, e.g. a Foxglove of your own").option("--origin");
    binder.field("topics", topics, "topics or patterns that Foxglove clients are offered, e.g. '/slam/*'")
        .option("--topics");
    binder.field("read_only", read_only, "no buttons: clients cannot call commands").option("--read-only");
    binder.field("publish", publish, "Foxglove clients may publish messages").option("--publish");
    binder.field("open", open, "open the page in the browser of this desktop, if there is one").option("--open");
    binder.field("max_kbps", max_kbps, {10, 1e6}, "kB/s that a page gets at most");
    binder.field("image_hz", image_hz, {0.1, 60}, "images per second that a page gets at most");
  }
};

/// rtd-viewer: shows a run in the browser, and to Foxglove clients, on one port. It only subscribes; the buttons are
/// calls of the other services' commands.
class ViewerService {
 public:
  static constexpr const char* kName = "viewer";
  static constexpr const char* kDescription = "Show poses, map, images and the state of all services in a browser";
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, std::vector<service::GivenOption>& given);

  /// Listens and joins the domain. Throws ConfigError and BusError.
  ViewerService(const Config& config, service::Runtime& runtime);
  ~ViewerService();
  ViewerService(const ViewerService&) = delete;
  ViewerService& operator=(const ViewerService&) = delete;
  service::ExitCode run();

 private:
  FoxgloveHooks foxglove_hooks();
  void call(const std::string& name, const std::string& argument, CommandQueue::Answer answer);
  void control_playback(const foxglove::PlaybackControl& control, CommandQueue::Answer answer);
  std::unique_ptr<Session> open(const std::string& subprotocol, Rights rights);
  Reports reports() const;
  std::vector<WatchedService> watched_services() const;
  void read_atlas();
  void find_robots();
  void apply_options();
  void refresh(std::int64_t now_ns);
  void refresh_commands();
  void refresh_playback();
  void report();
  void print_address() const;

  const Config config_;
  service::Runtime& runtime_;
  const std::string token_, look_token_;
  const Site site_;
  FoxgloveHub foxglove_;
  PageHub page_;
  std::shared_ptr<bus::RawBus> raw_;
  std::unique_ptr<WebServer> server_;
  std::optional<Dispatcher> dispatcher_;
  std::optional<TopicFeed> topics_;
  std::optional<CommandQueue> commands_;  ///< none: read-only
  std::map<std::string, std::unique_ptr<RobotFeed>> robots_;
  bus::Reader<msg::AtlasState> atlas_;
  bool robots_changed_ = true;
  std::int64_t refreshed_ns_ = 0;
};

}  // namespace rtd::viewer
