// Copyright 2026 diffdrive_kinematics contributors
//
// Licensed under the Apache License, Version 2.0 (the "License");
// you may not use this file except in compliance with the License.
// You may obtain a copy of the License at
//
//     http://www.apache.org/licenses/LICENSE-2.0
//
// Unless required by applicable law or agreed to in writing, software
// distributed under the License is distributed on an "AS IS" BASIS,
// WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
// See the License for the specific language governing permissions and
// limitations under the License.

// Steps the wall clock of one process: LD_PRELOAD this, and write an offset [s] into the file
// that WALL_CLOCK_OFFSET names, as a binary int64_t.  Other clocks go on as they do.  Who waits
// until a time on the wall clock waits on the one that is stepped, as the kernel has it.

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

#define SLICE 5000000  // [ns] after which a wait looks whether the clock was stepped
#define BY_MONOTONIC_CLOCK 2  // of a condition variable in glibc

static int (*real_clock_gettime)(clockid_t, struct timespec *);
static int (*real_wait)(pthread_cond_t *, pthread_mutex_t *, const struct timespec *);
static const volatile int64_t *offset;

__attribute__((constructor)) static void begin(void)
{
  real_clock_gettime = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
  void * wait = dlvsym(RTLD_NEXT, "pthread_cond_timedwait", "GLIBC_2.3.2");  // x86_64 has two
  real_wait = wait ? wait : dlsym(RTLD_NEXT, "pthread_cond_timedwait");
  const char * file = getenv("WALL_CLOCK_OFFSET");
  int descriptor = file ? open(file, O_RDONLY) : -1;
  void * map = mmap(NULL, sizeof(*offset), PROT_READ, MAP_SHARED, descriptor, 0);
  offset = map == MAP_FAILED ? NULL : map;
}

int clock_gettime(clockid_t clock, struct timespec * time)
{
  if (!real_clock_gettime) {
    begin();
  }
  int result = real_clock_gettime(clock, time);
  if (!result && offset && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) {
    time->tv_sec += *offset;
  }
  return result;
}

int pthread_cond_timedwait(
  pthread_cond_t * condition, pthread_mutex_t * mutex, const struct timespec * end)
{
  if (!offset || condition->__data.__wrefs & BY_MONOTONIC_CLOCK) {
    return real_wait(condition, mutex, end);
  }
  for (;; ) {
    struct timespec slice;
    real_clock_gettime(CLOCK_REALTIME, &slice);
    slice.tv_sec += (slice.tv_nsec + SLICE) / 1000000000;
    slice.tv_nsec = (slice.tv_nsec + SLICE) % 1000000000;
    struct timespec until = *end;
    until.tv_sec -= *offset;
    int last = until.tv_sec < slice.tv_sec ||
      (until.tv_sec == slice.tv_sec && until.tv_nsec <= slice.tv_nsec);
    int result = real_wait(condition, mutex, last ? &until : &slice);
    if (result != ETIMEDOUT || last) {
      return result;
    }
  }
}
