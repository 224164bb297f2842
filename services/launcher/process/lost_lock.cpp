// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/process/lost_lock.hpp"

#include <unistd.h>

#include <atomic>
#include <exception>
#include <string_view>

namespace rtd::launcher {
namespace {

std::atomic<std::uint64_t> lost{0};
std::terminate_handler otherwise = nullptr;

bool is_lost_lock(const std::exception_ptr& error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const std::exception& exception) {  // boost::interprocess_exception, which has no other mark
    return std::string_view(exception.what()).starts_with("Interprocess mutex timeout");
  } catch (...) {
  }
  return false;
}

[[noreturn]] void stand_still() {
  if (!is_lost_lock(std::current_exception())) otherwise();
  ++lost;
  for (;;) pause();
}

}  // namespace

void survive_lost_locks() {
  const std::terminate_handler before = std::set_terminate(stand_still);
  if (before != stand_still) otherwise = before;
}

std::uint64_t lost_locks() {
  return lost;
}

}  // namespace rtd::launcher
