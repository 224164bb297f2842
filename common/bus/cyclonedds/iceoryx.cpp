// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/iceoryx.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/bus/backend.hpp"

namespace rtd::bus::cyclonedds {

/// The daemon listens on a datagram socket: connecting to it sends nothing, and fails when nobody has it open, even if
/// the file was left behind.
void require_roudi(const std::string& socket_path) {
  const int probe = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (probe < 0) throw BusError(std::string("no socket to ask iox-roudi: ") + std::strerror(errno));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  const int failed = connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 ? 0 : errno;
  close(probe);
  if (failed == 0) return;
  const bool forbidden = failed == EACCES || failed == EPERM;
  throw BusError("bus.iceoryx is true, but " +
                 (forbidden ? "the iox-roudi of this host belongs to a user or group that we are not in (" +
                                  socket_path + ": " + std::strerror(failed) + ")"
                            : std::string("no iox-roudi runs on this host")) +
                 "; start it (package iceoryx: iox-roudi), or leave bus.iceoryx out");
}

}  // namespace rtd::bus::cyclonedds
