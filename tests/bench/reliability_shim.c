// LD_PRELOAD for tools/bench-reliability: a log of what a process writes to recordings and sends to its peers, kept in a
// mapped file (RELIABILITY_LOG) so that it outlives a SIGKILL. Records of four int64: kind, time in ns (CLOCK_MONOTONIC), a, b.
//   1 write to a recording: offset, bytes     2 cut back: -, size        3 sync returned: time it began, -
//   4 sent to the network: bytes so far, -
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { kRecords = 1 << 18, kStep = 50000 };

typedef struct {
  _Atomic int64_t used;
  int64_t spare[3];
  int64_t records[kRecords][4];
} Log;

static Log* the_log;
static _Atomic int64_t sent;

static int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static void note(int64_t kind, int64_t a, int64_t b) {
  if (!the_log) return;
  const int64_t at = atomic_fetch_add(&the_log->used, 1);
  if (at >= kRecords) return;
  the_log->records[at][1] = now_ns();
  the_log->records[at][2] = a;
  the_log->records[at][3] = b;
  the_log->records[at][0] = kind;
}

__attribute__((constructor)) static void open_log(void) {
  const char* path = getenv("RELIABILITY_LOG");
  if (!path) return;
  const int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0 || ftruncate(fd, sizeof(Log)) != 0) return;
  void* at = mmap(NULL, sizeof(Log), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  if (at != MAP_FAILED) the_log = at;
}

static int is_recording(int fd) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t n = readlink(link, path, sizeof path - 1);
  if (n < 5) return 0;
  path[n] = 0;
  return strcmp(path + n - 5, ".mcap") == 0 || strstr(path, ".mcap.partial") != NULL;
}

ssize_t write(int fd, const void* bytes, size_t size) {
  static ssize_t (*next)(int, const void*, size_t);
  if (!next) next = dlsym(RTLD_NEXT, "write");
  const int ours = the_log && fd > 2 && is_recording(fd);
  const int64_t at = ours ? (int64_t)lseek(fd, 0, SEEK_CUR) : 0;
  const ssize_t n = next(fd, bytes, size);
  if (ours && n > 0) note(1, at, n);
  return n;
}

int ftruncate(int fd, off_t size) {
  static int (*next)(int, off_t);
  if (!next) next = dlsym(RTLD_NEXT, "ftruncate");
  const int done = next(fd, size);
  if (done == 0 && the_log && is_recording(fd)) note(2, 0, size);
  return done;
}

int fdatasync(int fd) {
  static int (*next)(int);
  if (!next) next = dlsym(RTLD_NEXT, "fdatasync");
  const int64_t begun = now_ns();
  const int done = next(fd);
  if (done == 0 && is_recording(fd)) note(3, begun, 0);
  return done;
}

ssize_t sendmsg(int fd, const struct msghdr* message, int flags) {
  static ssize_t (*next)(int, const struct msghdr*, int);
  if (!next) next = dlsym(RTLD_NEXT, "sendmsg");
  const ssize_t n = next(fd, message, flags);
  if (n < 1000) return n;
  const int64_t before = atomic_fetch_add(&sent, n);
  if ((before + n) / kStep != before / kStep) note(4, before + n, 0);
  return n;
}
