// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/c_library.hpp"

#include <dlfcn.h>
#include <pthread.h>

#include <cerrno>
#include <cstring>
#include <ctime>

namespace rtd::bus::fastdds {

void link_c_library_functions() noexcept {}

}  // namespace rtd::bus::fastdds

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace {

/// The C library's function of this name.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// The owner died: the lock is ours, and others may use it again.
int recover(pthread_mutex_t* mutex, int result) {
  if (result != EOWNERDEAD) return result;
  return pthread_mutex_consistent(mutex);
}

constexpr double kStoodStill_s = 2;            // less than a lease
constexpr timespec kPatience{0, 700'000'000};  // the others' next messages arrive, and their leases begin again

bool is_fast_dds(const void* caller) {
  Dl_info info{};
  return dladdr(caller, &info) != 0 && info.dli_fname != nullptr && std::strstr(info.dli_fname, "libfast") != nullptr;
}

double seconds_since(clockid_t clock, const timespec& time) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec - time.tv_sec) + static_cast<double>(now.tv_nsec - time.tv_nsec) * 1e-9;
}

/// From the start when the process is stopped again meanwhile.
void be_patient() {
  timespec since{};
  do {
    clock_gettime(CLOCK_MONOTONIC, &since);
    nanosleep(&kPatience, nullptr);
  } while (seconds_since(CLOCK_MONOTONIC, since) > kStoodStill_s);
}

}  // namespace

extern "C" {

int pthread_mutexattr_setpshared(pthread_mutexattr_t* attributes, int shared) noexcept {
  static const auto original = next<int(pthread_mutexattr_t*, int)>("pthread_mutexattr_setpshared");
  const int result = original(attributes, shared);
  if (result != 0 || shared != PTHREAD_PROCESS_SHARED) return result;
  return pthread_mutexattr_setrobust(attributes, PTHREAD_MUTEX_ROBUST);
}

int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* until) noexcept {
  static const auto original = next<int(pthread_mutex_t*, const timespec*)>("pthread_mutex_timedlock");
  return recover(mutex, original(mutex, until));
}

int pthread_mutex_trylock(pthread_mutex_t* mutex) noexcept {
  static const auto original = next<int(pthread_mutex_t*)>("pthread_mutex_trylock");
  return recover(mutex, original(mutex));
}

int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  static const auto original = next<int(pthread_cond_t*, pthread_mutex_t*)>("pthread_cond_wait");
  return recover(mutex, original(condition, mutex));
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* until) {
  static const auto original = next<int(pthread_cond_t*, pthread_mutex_t*, const timespec*)>("pthread_cond_timedwait");
  return recover(mutex, original(condition, mutex, until));
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  using Function = int(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*);
  static const auto original = next<Function>("pthread_cond_clockwait");
  const int result = original(condition, mutex, clock, until);
  if (seconds_since(clock, *until) > kStoodStill_s && is_fast_dds(__builtin_return_address(0))) {
    pthread_mutex_unlock(mutex);
    be_patient();
    pthread_mutex_lock(mutex);
  }
  return result;
}

}  // extern "C"
#endif
