// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "services/viewer/core/access.hpp"
#include "services/viewer/web/site.hpp"

namespace rtd::viewer {

/// The server cannot start; what() names cause and fix.
class WebError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct WebOptions {
  std::string address = "127.0.0.1";  ///< numeric
  std::uint16_t port = 8765;          ///< 0: any free one
  AccessRules access;
  std::size_t most_clients = 128;              ///< WebSockets
  std::size_t most_visitors = 128;             ///< connections that are not yet one; beyond it the oldest is closed
  std::size_t longest_message_bytes = 65'536;  ///< of a client
  std::chrono::milliseconds patience{10'000};  ///< for the head of a request
};

/// A text that is made when it is asked for.
struct Report {
  std::string content;
  const char* type = "text/plain; charset=utf-8";  ///< MIME
  bool well = true;                                ///< else the answer is 503
};
/// By path: "/metrics".
using Reports = std::map<std::string, std::function<Report()>, std::less<>>;

struct WebCounts {
  std::size_t clients = 0;
  std::uint64_t sent_bytes = 0, requests = 0, refused = 0, closed_slow = 0;
};

/// HTTP and WebSocket on one port. Runs in the thread that calls run_for(); only post() may be called from others.
class WebServer {
 public:
  /// A client of this subprotocol connects; null refuses it.
  using Open = std::function<std::unique_ptr<Session>(const std::string& subprotocol, Rights rights)>;

  /// Listens from now on. Throws WebError. `site` outlives the server; so does what `open` and the reports use. Reports
  /// are made in the thread of run_for(); they ask for the token as a WebSocket does.
  static std::unique_ptr<WebServer> listen(const WebOptions& options, const Site& site, Open open,
                                           Reports reports = {});
  virtual ~WebServer() = default;

  virtual std::uint16_t port() const = 0;
  /// Serves clients and runs what was posted, for this long.
  virtual void run_for(std::chrono::milliseconds time) = 0;
  virtual void post(std::function<void()> task) = 0;
  /// Asks every session for messages that are due.
  virtual void pump() = 0;
  virtual WebCounts counts() const = 0;
};

}  // namespace rtd::viewer
