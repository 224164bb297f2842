// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/standard_streams.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

namespace rtd::service {
namespace {

/// The status of a child that does this.
int status_of(const auto& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(StandardStreams, a_file_never_gets_the_number_of_a_closed_stream) {
  const int status = status_of([] {
    ::close(STDERR_FILENO);
    ::close(STDIN_FILENO);
    prepare_standard_streams();
    const int file = ::open("/dev/zero", O_RDONLY);
    return file > STDERR_FILENO && ::write(STDERR_FILENO, "x", 1) == 1 ? 0 : 1;
  });
  EXPECT_EQ(status, 0);
}

TEST(StandardStreams, output_without_a_reader_ends_no_process) {
  const int status = status_of([] {
    int ends[2];
    if (::pipe(ends) != 0) return 2;
    ::close(ends[0]);
    outlive_readers();
    return ::write(ends[1], "x", 1) < 0 ? 0 : 1;
  });
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace rtd::service
