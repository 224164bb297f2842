// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/c_library.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <string_view>

#include "common/bus/host/shm_names.hpp"

namespace rtd::bus::fastdds {

void link_c_library_functions() noexcept {}

}  // namespace rtd::bus::fastdds

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace {

using namespace rtd::bus;

/// The C library's function of this name.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// A flag that the C library keeps in the lock.
bool is_robust(const pthread_mutex_t& mutex) {
  constexpr int kRobust = 16;
  return (mutex.__data.__kind & kRobust) != 0;
}

timespec in_a_second(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  ++time.tv_sec;
  return time;
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
void wait_for_announcements() {
  timespec since{};
  do {
    clock_gettime(CLOCK_MONOTONIC, &since);
    nanosleep(&kPatience, nullptr);
  } while (seconds_since(CLOCK_MONOTONIC, since) > kStoodStill_s);
}

/// Whoever holds such a file listens at a port, or owns a segment.
bool is_lock_file(std::string_view path) {
  return path.starts_with(kFastddsPaths) && (path.ends_with(kPortLock) || path.ends_with(kSegmentLock));
}

/// The path by which it was opened, also when that has been removed.
std::string path_of(int file) {
  constexpr std::string_view kRemoved = " (deleted)";
  char link[32], path[256];
  std::snprintf(link, sizeof(link), "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, sizeof(path));
  const std::string_view found(path, length > 0 ? static_cast<std::size_t>(length) : 0);
  return std::string(found.ends_with(kRemoved) ? found.substr(0, found.size() - kRemoved.size()) : found);
}

bool is_trial(std::string_view path) {
  return path.starts_with(kShmRing);
}

std::string in_shared_memory(const char* path) {
  return std::string("/dev/shm/") + path;
}

/// "/fastrtps_4ad1268c17b61829", but no port: whoever sends has one.
bool is_segment(std::string_view name) {
  name.remove_prefix(name.starts_with('/') ? 1 : 0);
  return is_shm_transport(name) && name.find(kShmPort) == std::string_view::npos;
}

/// What is in the file now, in memory of this process; holes stay holes. Negative when there is none, or when it and
/// what was copied before are more than any of our own programs has: memory is not for others to take.
int copy_of(int file) {
  constexpr std::int64_t kMostBytes = 64 << 20, kBlockBytes = 512;
  static std::atomic<std::int64_t> copied_bytes = 0;
  struct stat status {};
  if (fstat(file, &status) != 0) return -1;
  std::int64_t left = status.st_blocks * kBlockBytes;
  if (left > kMostBytes - copied_bytes) {
    errno = EACCES;
    return -1;
  }
  copied_bytes += left;
  const int copy = memfd_create("segment_of_another_user", MFD_CLOEXEC);
  if (copy < 0 || ftruncate(copy, status.st_size) != 0) return copy;
  for (off_t at = lseek(file, 0, SEEK_DATA); at >= 0 && left > 0; at = lseek(file, at, SEEK_DATA)) {
    const std::int64_t bytes = std::min<std::int64_t>(left, lseek(file, at, SEEK_HOLE) - at);
    lseek(copy, at, SEEK_SET);
    const ssize_t sent = sendfile(copy, file, &at, static_cast<std::size_t>(bytes));
    if (sent <= 0) break;
    left -= sent;
  }
  return copy;
}

bool has_name(int file) {
  struct stat status {};
  return fstat(file, &status) == 0 && status.st_nlink > 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  static const auto original = next<int(const char*, int, ...)>("open");
  std::va_list arguments;
  va_start(arguments, flags);
  const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  const mode_t mode = creates ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  return is_trial(path) ? original(in_shared_memory(path).c_str(), flags, mode) : original(path, flags, mode);
}

int open64(const char* path, int flags, ...) __attribute__((alias("open")));

int shm_open(const char* name, int flags, mode_t mode) {
  static const auto original = next<int(const char*, int, mode_t)>("shm_open");
  const int file = original(name, flags, mode);
  if (file >= 0 || errno != EACCES || !is_segment(name)) return file;
  const int theirs = original(name, O_RDONLY, 0);
  if (theirs < 0) return theirs;
  const int copy = copy_of(theirs);
  const int why = errno;
  close(theirs);
  errno = why;
  return copy;
}

int unlink(const char* path) noexcept {
  static const auto original = next<int(const char*)>("unlink");
  return is_trial(path) ? original(in_shared_memory(path).c_str()) : original(path);
}

int flock(int file, int operation) noexcept {
  static const auto original = next<int(int, int)>("flock");
  const std::string path = path_of(file);
  if (!is_lock_file(path)) return original(file, operation);
  if ((operation & LOCK_UN) != 0) {
    if (original(file, LOCK_EX | LOCK_NB) == 0 && has_name(file)) unlink(path.c_str());
    return original(file, operation);
  }
  const int result = original(file, operation);
  if (result != 0 || has_name(file)) return result;
  original(file, LOCK_UN);
  errno = EWOULDBLOCK;
  return -1;
}

/// Fast DDS calls it for a lock file that it has unlocked: removes it unless another has locked it since.
int remove(const char* path) noexcept {
  static const auto original = next<int(const char*)>("remove");
  if (!is_lock_file(path)) return original(path);
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  if (flock(file, LOCK_EX | LOCK_NB) == 0) flock(file, LOCK_UN);
  close(file);
  return 0;
}

int pthread_mutexattr_setpshared(pthread_mutexattr_t* attributes, int shared) noexcept {
  static const auto original = next<int(pthread_mutexattr_t*, int)>("pthread_mutexattr_setpshared");
  const int result = original(attributes, shared);
  if (result != 0 || shared != PTHREAD_PROCESS_SHARED) return result;
  return pthread_mutexattr_setrobust(attributes, PTHREAD_MUTEX_ROBUST);
}

int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* until) noexcept {
  static const auto original = next<int(pthread_mutex_t*, const timespec*)>("pthread_mutex_timedlock");
  int result = original(mutex, until);
  while (result == ETIMEDOUT && is_robust(*mutex)) {
    const timespec again = in_a_second(CLOCK_REALTIME);
    result = original(mutex, &again);
  }
  return result == EOWNERDEAD ? pthread_mutex_consistent(mutex) : result;  // it is ours, and others may use it again
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  using Function = int(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*);
  static const auto original = next<Function>("pthread_cond_clockwait");
  const int result = original(condition, mutex, clock, until);
  if (seconds_since(clock, *until) > kStoodStill_s && is_fast_dds(__builtin_return_address(0))) {
    pthread_mutex_unlock(mutex);
    wait_for_announcements();
    pthread_mutex_lock(mutex);
  }
  return result;
}

}  // extern "C"
#endif
