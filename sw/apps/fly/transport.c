#include "transport.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "clock.h"

#define REOPEN_NS FLY_SECOND
#define DEFAULT_BAUD 921600

static const struct {
  long baud;
  speed_t speed;
} speeds[] = {{9600, B9600},       {19200, B19200},     {38400, B38400},    {57600, B57600},   {115200, B115200},
              {230400, B230400},   {460800, B460800},   {500000, B500000},  {921600, B921600}, {1000000, B1000000},
              {1500000, B1500000}, {2000000, B2000000}, {3000000, B3000000}};

/* 0: none that a serial line has. */
static speed_t speed_of(long baud) {
  for (size_t k = 0; k < sizeof speeds / sizeof speeds[0]; ++k)
    if (speeds[k].baud == baud) return speeds[k].speed;
  return 0;
}

/* Digits alone. -1: not that, or above a million and some. */
static long number_of(const char *text) {
  if (text[0] == '\0' || strlen(text) > 7 || text[strspn(text, "0123456789")] != '\0') return -1;
  return strtol(text, NULL, 10);
}

static bool wrong(problem *p, const char *target) {
  return problem_say(p, target, "is neither udp:ADDRESS:PORT nor serial:DEVICE[:BAUD]");
}

static bool set_address(transport *t, const char *host, long port) {
  struct sockaddr_in *const four = (struct sockaddr_in *)(void *)&t->address;
  struct sockaddr_in6 *const six = (struct sockaddr_in6 *)(void *)&t->address;
  if (strcmp(host, "localhost") == 0) host = "127.0.0.1";
  if (inet_pton(AF_INET, host, &four->sin_addr) == 1) {
    four->sin_family = AF_INET;
    four->sin_port = htons((uint16_t)port);
    t->address_bytes = sizeof *four;
    return true;
  }
  char bare[INET6_ADDRSTRLEN + 2];
  const size_t length = strlen(host);
  if (length < 3 || length >= sizeof bare || host[0] != '[' || host[length - 1] != ']') return false;
  (void)snprintf(bare, sizeof bare, "%.*s", (int)length - 2, host + 1);
  if (inet_pton(AF_INET6, bare, &six->sin6_addr) != 1) return false;
  six->sin6_family = AF_INET6;
  six->sin6_port = htons((uint16_t)port);
  t->address_bytes = sizeof *six;
  return true;
}

/* Whoever is told on this machine answers on it, and nobody else is listened to. */
static bool bind_to(const transport *t, int port) {
  struct sockaddr_in four = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
  struct sockaddr_in6 six = {.sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port)};
  const in_addr_t told = ((const struct sockaddr_in *)(const void *)&t->address)->sin_addr.s_addr;
  const struct in6_addr *const told6 = &((const struct sockaddr_in6 *)(const void *)&t->address)->sin6_addr;
  if (ntohl(told) >> 24 == IN_LOOPBACKNET) four.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (t->address.ss_family == AF_INET6 && IN6_IS_ADDR_LOOPBACK(told6)) six.sin6_addr = in6addr_loopback;
  if (t->address.ss_family == AF_INET) return bind(t->file, (struct sockaddr *)(void *)&four, sizeof four) == 0;
  return bind(t->file, (struct sockaddr *)(void *)&six, sizeof six) == 0;
}

static bool open_udp(transport *t, const char *target, char *rest, int listen_port, problem *p) {
  char *const colon = strrchr(rest, ':');
  const long port = colon != NULL ? number_of(colon + 1) : -1;
  if (port < 1 || port > 65535 || colon == rest) return wrong(p, target);
  *colon = '\0';
  if (!set_address(t, rest, port))
    return problem_say(p, target, "no numeric address: names are not looked up in flight");
  t->file = socket(t->address.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (t->file < 0) return problem_errno(p, target, errno);
  if (bind_to(t, listen_port)) return true;
  const int number = errno;
  char port_text[32];
  (void)snprintf(port_text, sizeof port_text, "--listen %d", listen_port);
  return problem_errno(p, listen_port > 0 ? port_text : target, number);
}

static bool open_line(transport *t) {
  struct termios settings;
  t->tried_ns = fly_now_ns();
  t->file = open(t->device, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (t->file < 0) return false;
  bool set = tcgetattr(t->file, &settings) == 0;
  settings.c_iflag &= (tcflag_t) ~(IGNBRK | BRKINT | PARMRK | ISTRIP | INLCR | IGNCR | ICRNL | IXON | IXOFF);
  settings.c_oflag &= (tcflag_t)~OPOST;
  settings.c_lflag &= (tcflag_t) ~(ECHO | ECHONL | ICANON | ISIG | IEXTEN);
  settings.c_cflag &= (tcflag_t) ~(CSIZE | PARENB | CSTOPB | CRTSCTS);
  settings.c_cflag |= CS8 | CLOCAL | CREAD;
  set = set && cfsetispeed(&settings, (speed_t)t->speed) == 0 && cfsetospeed(&settings, (speed_t)t->speed) == 0 &&
        tcsetattr(t->file, TCSANOW, &settings) == 0;
  if (set) return true;
  const int number = errno;
  transport_close(t);
  errno = number;
  return false;
}

static bool open_serial(transport *t, const char *target, char *rest, problem *p) {
  long baud = DEFAULT_BAUD;
  char *const colon = strrchr(rest, ':'); /* devices in /dev/serial/by-path have colons of their own */
  if (colon != NULL && number_of(colon + 1) > 0) {
    baud = number_of(colon + 1);
    *colon = '\0';
  }
  t->serial = true;
  t->speed = speed_of(baud);
  if (rest[0] == '\0') return wrong(p, target);
  if (t->speed == 0) return problem_say(p, target, "no speed of a serial line: %ld", baud);
  (void)snprintf(t->device, sizeof t->device, "%s", rest);
  return open_line(t) || problem_errno(p, target, errno);
}

bool transport_open(transport *t, const char *target, int listen_port, problem *p) {
  char text[TRANSPORT_DEVICE_BYTES];
  *t = (transport){.file = -1};
  if (strlen(target) >= sizeof text) return wrong(p, target);
  (void)snprintf(text, sizeof text, "%s", target);
  if (strncmp(text, "udp:", 4) == 0) return open_udp(t, target, text + 4, listen_port, p);
  return strncmp(text, "serial:", 7) == 0 ? open_serial(t, target, text + 7, p) : wrong(p, target);
}

/* Whether there is something to write to and read from; a serial line that has gone is opened again. */
static bool is_there(transport *t) {
  if (t->file < 0 && t->serial && fly_now_ns() - t->tried_ns >= REOPEN_NS) (void)open_line(t);
  return t->file >= 0;
}

void transport_send(transport *t, const uint8_t *bytes, int32_t count) {
  if (!is_there(t)) {
    ++t->lost;
    return;
  }
  const ssize_t sent = t->serial ? write(t->file, bytes, (size_t)count)
                                 : sendto(t->file, bytes, (size_t)count, MSG_NOSIGNAL,
                                          (const struct sockaddr *)(const void *)&t->address, t->address_bytes);
  if (sent == (ssize_t)count) return;
  ++t->lost;
  if (!t->serial) return; /* no route, no room, nobody there: the next may arrive */
  if (sent >= 0 || errno == EAGAIN)
    (void)tcflush(t->file, TCOFLUSH); /* too slow a line: the rest of the message is dropped */
  else
    transport_close(t);
}

static bool from_target(const transport *t, const struct sockaddr_storage *from) {
  if (from->ss_family != t->address.ss_family) return false;
  if (from->ss_family == AF_INET)
    return ((const struct sockaddr_in *)(const void *)from)->sin_addr.s_addr ==
           ((const struct sockaddr_in *)(const void *)&t->address)->sin_addr.s_addr;
  return memcmp(&((const struct sockaddr_in6 *)(const void *)from)->sin6_addr,
                &((const struct sockaddr_in6 *)(const void *)&t->address)->sin6_addr, sizeof(struct in6_addr)) == 0;
}

int32_t transport_receive(transport *t, int timeout_ms, uint8_t *bytes, int32_t capacity) {
  struct sockaddr_storage from = {0};
  socklen_t from_bytes = sizeof from;
  struct pollfd ready = {is_there(t) ? t->file : -1, POLLIN, 0}; /* without a file poll only waits */
  if (poll(&ready, 1, timeout_ms) < 1 || ready.revents == 0) return 0;
  const ssize_t got =
      t->serial ? read(t->file, bytes, (size_t)capacity)
                /* NOLINTNEXTLINE(clang-analyzer-unix.StdCLibraryFunctions): without a file poll tells of nothing */
                : recvfrom(t->file, bytes, (size_t)capacity, 0, (struct sockaddr *)(void *)&from, &from_bytes);
  if (t->serial && (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR))) transport_close(t);
  if (got <= 0) return 0;
  return t->serial || from_target(t, &from) ? (int32_t)got : 0;
}

void transport_close(transport *t) {
  if (t->file >= 0) (void)close(t->file);
  t->file = -1;
}
