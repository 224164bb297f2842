// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/viewer/core/outbox.hpp"

namespace rtd::viewer {

/// What a client may do.
enum class Rights { kLook, kControl };  ///< kControl: also call commands, set parameters, publish

/// The answer to a client without them: cause and fix.
inline constexpr const char* kOnlyLooks =
    "commands are off: the viewer was started with --read-only, or this client does not know the token of the address "
    "that the viewer has printed (?token=...)";

/// One connected client, without its socket. One thread.
class Session {
 public:
  virtual ~Session() = default;
  virtual void on_text(std::string_view text) = 0;
  virtual void on_binary(std::span<const std::byte> bytes) = 0;
  /// The next message to send now, if any. Asked again once that one is sent, and when something has happened.
  virtual std::optional<Frame> next(std::int64_t now_ns) = 0;
  /// The client does not take what must not be dropped, and is to be closed.
  virtual bool overflowed() const = 0;
};

/// Who may connect. A web page of another site may open a connection to this host from the user's browser, and a name
/// of its own may point here: so Host and Origin are checked.
struct AccessRules {
  std::vector<std::string> hosts;    ///< names by which this server may be addressed, besides loopback; empty: any
  std::vector<std::string> origins;  ///< of other sites whose pages may connect: "https://app.foxglove.dev"
  std::string token;                 ///< empty: none is asked for
  std::string look_token = {};       ///< who knows this one may look, and only that; empty: there is none
  bool look_freely = false;          ///< a client without the token may look, and only that: also a page that
                                     ///< outlives the viewer and has the token of the one before
};

/// The parts of a request that matter.
struct AccessRequest {
  std::string_view host, origin, target, authorization;
};

enum class Access { kGranted, kToLook, kWrongHost, kWrongOrigin, kAnonymousOrigin, kNoToken };

/// Whether a WebSocket may be opened, and for what. A request without Origin is not of a browser. The origins "file://"
/// and "null" say nothing about who wrote the page: they need the token even to look.
Access check_access(const AccessRules& rules, const AccessRequest& request);
/// Granted, or to look only.
inline bool may_look(Access access) {
  return access == Access::kGranted || access == Access::kToLook;
}
/// Whether a page may be read: no token is asked for.
Access check_host(const AccessRules& rules, std::string_view host);
/// Of a host as requests name it ("localhost", "[::1]"), or an address ("127.0.0.1", "::1").
bool is_loopback(std::string_view host);
/// For the answer: cause and fix.
const char* explain(Access access);

/// "token" of "/live?token=abc&x": "abc". Percent-encoding is undone.
std::string query_value(std::string_view target, std::string_view name);
/// "/live?x" -> "/live"
std::string_view path_of(std::string_view target);

}  // namespace rtd::viewer
