// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Preloaded into the processes of a run (tests/campaigns/chaos.py): shifts their CLOCK_REALTIME by the 64-bit number of
// nanoseconds in the file that RTD_CLOCK_STEP_FILE names, which may change at any time. So a clock can be stepped without
// touching that of the host.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static const volatile int64_t* step_ns;
static int (*real_gettime)(clockid_t, struct timespec*);
static int (*real_cond)(pthread_cond_t*, pthread_mutex_t*, const struct timespec*);
static int (*real_mutex)(pthread_mutex_t*, const struct timespec*);
static int (*real_semaphore)(sem_t*, const struct timespec*);

enum { kBillion = 1000000000 };

__attribute__((constructor)) static void open_step(void) {
  real_gettime = (int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime");
  // Plain dlsym finds the version of 1999, whose condition variables are smaller.
  real_cond = (int (*)(pthread_cond_t*, pthread_mutex_t*, const struct timespec*))dlvsym(
      RTLD_NEXT, "pthread_cond_timedwait", "GLIBC_2.3.2");
  real_mutex = (int (*)(pthread_mutex_t*, const struct timespec*))dlsym(RTLD_NEXT, "pthread_mutex_timedlock");
  real_semaphore = (int (*)(sem_t*, const struct timespec*))dlsym(RTLD_NEXT, "sem_timedwait");
  const char* path = getenv("RTD_CLOCK_STEP_FILE");
  const int file = path == NULL ? -1 : open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  void* mapped = mmap(NULL, sizeof(int64_t), PROT_READ, MAP_SHARED, file, 0);
  close(file);
  if (mapped != MAP_FAILED) step_ns = (const volatile int64_t*)mapped;
}

static struct timespec shifted(struct timespec at, int64_t by_ns) {
  at.tv_sec += by_ns / kBillion;
  at.tv_nsec += by_ns % kBillion;
  if (at.tv_nsec >= kBillion) {
    at.tv_sec += 1;
    at.tv_nsec -= kBillion;
  }
  if (at.tv_nsec < 0) {
    at.tv_sec -= 1;
    at.tv_nsec += kBillion;
  }
  return at;
}

int clock_gettime(clockid_t clock, struct timespec* at) {
  if (real_gettime == NULL) open_step();
  const int result = real_gettime(clock, at);
  if (result == 0 && step_ns != NULL && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
    *at = shifted(*at, *step_ns);
  return result;
}

int gettimeofday(struct timeval* restrict at, void* restrict zone) {
  (void)zone;
  struct timespec now;
  const int result = clock_gettime(CLOCK_REALTIME, &now);
  at->tv_sec = now.tv_sec;
  at->tv_usec = now.tv_nsec / 1000;
  return result;
}

time_t time(time_t* at) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (at != NULL) *at = now.tv_sec;
  return now.tv_sec;
}

// Deadlines on the real-time clock were computed with the shifted clock; those on the monotonic clock are far smaller.
static struct timespec real_deadline(const struct timespec* until) {
  return step_ns == NULL || until->tv_sec < kBillion ? *until : shifted(*until, -*step_ns);
}

int pthread_cond_timedwait(pthread_cond_t* restrict condition, pthread_mutex_t* restrict mutex,
                           const struct timespec* restrict until) {
  const struct timespec deadline = real_deadline(until);
  return real_cond(condition, mutex, &deadline);
}

int pthread_mutex_timedlock(pthread_mutex_t* restrict mutex, const struct timespec* restrict until) {
  const struct timespec deadline = real_deadline(until);
  return real_mutex(mutex, &deadline);
}

int sem_timedwait(sem_t* restrict semaphore, const struct timespec* restrict until) {
  const struct timespec deadline = real_deadline(until);
  return real_semaphore(semaphore, &deadline);
}
