// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

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

}  // namespace rtd::viewer
