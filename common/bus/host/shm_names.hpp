// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

/// Fast DDS's files in shared memory: "fastrtps_4ad1268c17b61829" is a segment, "fastdds_port24161" a port,
/// "fast_datasharing_01.0f..." a ring. Their locks and semaphores have these names with a prefix or suffix.
namespace rtd::bus {

inline constexpr char kShmFolder[] = "/dev/shm";
/// How the paths of all of them begin.
inline constexpr std::string_view kFastddsPaths = "/dev/shm/fast";
/// Segments and ports of Fast DDS 2, those of 3, rings of both.
inline constexpr std::array<std::string_view, 3> kShmNames = {"fastrtps_", "fastdds_", "fast_datasharing_"};
inline constexpr std::string_view kShmPort = "port", kShmRing = kShmNames[2];
/// Who holds the first listens at a port, the second owns a segment, the third makes one of them.
inline constexpr std::string_view kPortLock = "_el", kSegmentLock = "_sl", kMakingLock = "_mutex", kSemaphore = "sem.";

/// Of a segment or port.
constexpr bool is_shm_transport(std::string_view name) {
  return name.starts_with(kShmNames[0]) || name.starts_with(kShmNames[1]);
}

}  // namespace rtd::bus
