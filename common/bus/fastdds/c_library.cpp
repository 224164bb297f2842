// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/robust_locks.hpp"

#include <dlfcn.h>
#include <pthread.h>

#include <cerrno>
#include <ctime>

namespace rtd::bus::fastdds {

void link_robust_locks() noexcept {}

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

}  // extern "C"
#endif
