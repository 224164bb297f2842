// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/host/host_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace rtd::bus {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kMib = 1024 * 1024;
const HostLimits kAmple{2048 * kMib, 2048 * kMib, 4 * kMib, 4 * kMib};

std::string shared_memory_error(const BusOptions& options, const HostLimits& limits) {
  try {
    require_shared_memory(options, limits);
  } catch (const BusError& error) {
    return error.what();
  }
  return {};
}

TEST(HostChecks, an_ample_host_passes_without_a_warning) {
  EXPECT_EQ(shared_memory_error({}, kAmple), "");
  EXPECT_THAT(host_warnings({}, kAmple), IsEmpty());
}

TEST(HostChecks, too_small_shared_memory_is_refused_with_size_and_fix) {
  HostLimits limits = kAmple;
  limits.shm_total = limits.shm_free = 8 * kMib;
  EXPECT_THAT(shared_memory_error({}, limits), AllOf(HasSubstr("/dev/shm"), HasSubstr("8 MiB"), HasSubstr("25 MiB"),
                                                     HasSubstr("mount -o remount,size="), HasSubstr("--shm-size=")));
}

TEST(HostChecks, full_shared_memory_is_refused_though_large) {
  HostLimits limits = kAmple;
  limits.shm_free = 10 * kMib;
  EXPECT_THAT(shared_memory_error({}, limits), HasSubstr("10 MiB free of 2048 MiB"));
}

TEST(HostChecks, a_larger_segment_needs_more_shared_memory) {
  HostLimits limits = kAmple;
  limits.shm_free = 64 * kMib;
  BusOptions options;
  EXPECT_EQ(shared_memory_error(options, limits), "");
  options.shm_segment_mib = 64;
  EXPECT_THAT(shared_memory_error(options, limits), HasSubstr("73 MiB"));
}

TEST(HostChecks, the_64_mib_of_a_default_container_are_warned_of) {
  HostLimits limits = kAmple;
  limits.shm_total = limits.shm_free = 64 * kMib;
  EXPECT_EQ(shared_memory_error({}, limits), "");
  EXPECT_THAT(host_warnings({}, limits), testing::ElementsAre(AllOf(HasSubstr("64 MiB"), HasSubstr("--shm-size="))));
}

TEST(HostChecks, small_socket_buffers_are_warned_of_with_the_command) {
  HostLimits limits = kAmple;
  limits.rmem_max = limits.wmem_max = 212'992;
  EXPECT_THAT(host_warnings({}, limits), testing::ElementsAre(HasSubstr("sudo sysctl -w net.core.rmem_max=4194304"),
                                                              HasSubstr("sudo sysctl -w net.core.wmem_max=4194304")));
}

TEST(HostChecks, what_could_not_be_read_is_not_complained_about) {
  EXPECT_EQ(shared_memory_error({}, HostLimits{}), "");
  EXPECT_THAT(host_warnings({}, HostLimits{}), IsEmpty());
  const HostLimits limits = read_host_limits("/nonexistent", "/nonexistent");
  EXPECT_EQ(limits.shm_total, 0U);
  EXPECT_EQ(limits.rmem_max, 0U);
}

TEST(HostChecks, ports_of_another_user_in_the_domain_are_named_with_udp_in_their_place) {
  if (geteuid() != 0) GTEST_SKIP() << "only root makes files of another user";
  const std::filesystem::path shm = std::filesystem::temp_directory_path() / ("rtd_shm_" + std::to_string(getpid()));
  std::filesystem::create_directory(shm);
  const auto add = [&](const std::string& name, uid_t user, mode_t mode) {
    const std::string path = shm / name;
    std::ofstream(path) << 'x';
    EXPECT_EQ(chmod(path.c_str(), mode) + chown(path.c_str(), user, user), 0);
  };
  add("fastrtps_port24161", 0, 0644);      // ours
  add("fastdds_port24163", 65534, 0666);   // open to all
  add("fastrtps_port24661", 65534, 0644);  // of domain 69
  add("fastrtps_1b3f0e", 65534, 0644);     // not a port
  add("fastrtps_port24661_el", 65534, 0644);
  BusOptions options;
  options.vendor = "fastdds";
  options.domain = 67;
  EXPECT_EQ(why_not_shared_memory(options, read_host_limits(shm)), "");
  add("fastrtps_port24165", 65534, 0644);
  const HostLimits limits = read_host_limits(shm);
  EXPECT_THAT(why_not_shared_memory(options, limits),
              AllOf(HasSubstr("user 65534"), HasSubstr("domain 67"), HasSubstr("port 24165"), HasSubstr("UDP")));
  EXPECT_THAT(host_warnings(options, limits), testing::Contains(HasSubstr("user 65534")));
  options.vendor = "cyclonedds";
  EXPECT_EQ(why_not_shared_memory(options, limits), "");
  std::filesystem::remove_all(shm);
}

TEST(HostChecks, the_inprocess_bus_needs_nothing_of_the_host) {
  BusOptions options;
  options.vendor = kInprocess;
  EXPECT_THAT(host_warnings(options, {8 * kMib, kMib, 1000, 1000}), IsEmpty());
}

TEST(HostChecks, socket_buffer_is_capped_by_what_the_kernel_grants) {
  EXPECT_EQ(socket_buffer_bytes(4096, 4 * kMib), 4 * kMib);
  EXPECT_EQ(socket_buffer_bytes(4096, 212'992), 212'992U);
  EXPECT_EQ(socket_buffer_bytes(4096, 0), 4 * kMib);
}

}  // namespace
}  // namespace rtd::bus
