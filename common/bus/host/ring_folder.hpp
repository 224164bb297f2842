// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::bus {

/// How the folders of rings in shared memory begin.
inline constexpr char kRingsPrefix[] = "rtd_rings_";
/// Names the folder of BusOptions::rings: `rtd run` sets it for its services.
inline constexpr char kRingsVariable[] = "RTD_RINGS";

/// The folder in which writers of frames have their rings and readers look for them: `asked`, else one for this user.
/// Made where there is none. Another user can neither enter it nor put a ring there. Empty when it cannot be made or is
/// not for this user alone, as when another user was faster: then frames go without rings.
std::string ring_folder(const std::string& asked);

/// A new folder of rings for the services that this process starts: in their environment, and removed at the end.
/// Without shared memory there is none, and they use that of this user.
class RingsOfRun {
 public:
  RingsOfRun();
  ~RingsOfRun();
  RingsOfRun(const RingsOfRun&) = delete;
  RingsOfRun& operator=(const RingsOfRun&) = delete;

 private:
  std::string folder_;
};

}  // namespace rtd::bus
