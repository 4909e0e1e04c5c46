// Loaded before the simulator target of Betaflight (LD_PRELOAD), so that it flies in the time of the simulation.
//
// As published it runs by the clock of the computer, which goes on while images are rendered, and listens on fixed
// ports of every interface. Here its main thread has a clock of its own: a reading takes READING_NS, a sleep as long
// as it asks for, and at the end of the time that it was given it says so and waits for more. So the same flight is
// the same to the byte. Its ports are moved by an offset and belong to the loopback interface, so that flights can go
// side by side.
//
// VISTA_LOCKSTEP is "GIVEN DONE OFFSET": the descriptor from which the end of the time given is read (int64_t, ns of
// the main thread's clock, which begins at 1 s), the descriptor to which a byte is written ('w': the main thread
// waits; 'p': a packet was taken), and the offset of the ports.
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <dlfcn.h>
#include <netinet/in.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

// The function of this name that would be called if this library were not there.
#define REAL(name) ((__typeof__(&(name)))dlsym(RTLD_NEXT, #name))

enum { READING_NS = 200, NS_S = 1000000000 };

// What stands in for functions of the C library has no other place to keep its state in.
static int given_fd, done_fd, offset;
static _Atomic int64_t now_ns = NS_S;
static int64_t end_ns = NS_S;
static _Thread_local bool is_main, took_packet;

__attribute__((constructor)) static void begin(void) {
  const char *told = getenv("VISTA_LOCKSTEP");
  if (told == NULL || sscanf(told, "%d %d %d", &given_fd, &done_fd, &offset) != 3) {
    fputs("lockstep: VISTA_LOCKSTEP must be \"GIVEN DONE OFFSET\"\n", stderr);
    _exit(2);
  }
  is_main = true;
}

static void say(char what) {
  if (write(done_fd, &what, 1) != 1) {
    _exit(0); // the simulation has ended
  }
}

static void pass_ns(int64_t ns) {
  const int64_t then_ns = atomic_load(&now_ns) + ns;
  if (then_ns < end_ns) {
    atomic_store(&now_ns, then_ns);
    return;
  }
  atomic_store(&now_ns, end_ns);
  say('w');
  if (read(given_fd, &end_ns, sizeof end_ns) != sizeof end_ns) {
    _exit(0);
  }
}

int clock_gettime(clockid_t clock, struct timespec *time) {
  if (clock != CLOCK_MONOTONIC) {
    return REAL(clock_gettime)(clock, time);
  }
  if (is_main) {
    pass_ns(READING_NS);
  }
  const int64_t now = atomic_load(&now_ns);
  *time = (struct timespec){.tv_sec = now / NS_S, .tv_nsec = now % NS_S};
  return 0;
}

int nanosleep(const struct timespec *asked, struct timespec *left) {
  if (!is_main) {
    return REAL(nanosleep)(asked, left);
  }
  pass_ns((int64_t)asked->tv_sec * NS_S + asked->tv_nsec);
  return 0;
}

ssize_t recvfrom(int fd, void *data, size_t size, int flags, struct sockaddr *from, socklen_t *length) {
  const ssize_t taken = REAL(recvfrom)(fd, data, size, flags, from, length);
  took_packet = taken > 0;
  return taken;
}

// Here the threads that take packets wait for the next one, and have done what the last one asked for.
int select(int count, fd_set *reads, fd_set *writes, fd_set *errors, struct timeval *longest) {
  if (took_packet) {
    took_packet = false;
    say('p');
  }
  return REAL(select)(count, reads, writes, errors, longest);
}

static struct sockaddr_in moved(const struct sockaddr *address) {
  struct sockaddr_in result = *(const struct sockaddr_in *)address;
  result.sin_port = htons((uint16_t)(ntohs(result.sin_port) + offset));
  result.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return result;
}

int bind(int fd, const struct sockaddr *address, socklen_t length) {
  if (address->sa_family != AF_INET) {
    return REAL(bind)(fd, address, length);
  }
  const struct sockaddr_in here = moved(address);
  return REAL(bind)(fd, (const struct sockaddr *)&here, sizeof here);
}

ssize_t sendto(int fd, const void *data, size_t size, int flags, const struct sockaddr *to, socklen_t length) {
  if (to == NULL || to->sa_family != AF_INET) {
    return REAL(sendto)(fd, data, size, flags, to, length);
  }
  const struct sockaddr_in there = moved(to);
  return REAL(sendto)(fd, data, size, flags, (const struct sockaddr *)&there, sizeof there);
}
