/* vista-fly: the flying program. doc/flying.md describes it. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

#include "flight.h"
#include "vista/version.h"

#define EXIT_INPUT 2
#define EXIT_INTERRUPTED 130

static atomic_bool interrupted; /* a signal reaches nothing else */

static void interrupt(int number) {
  (void)number;
  atomic_store(&interrupted, true);
}

/* The second Ctrl-C ends the program at once. */
static void watch_signals(void) {
  struct sigaction action = {.sa_handler = interrupt, .sa_flags = (int)SA_RESETHAND};
  (void)sigemptyset(&action.sa_mask);
  (void)sigaction(SIGINT, &action, NULL);
  (void)sigaction(SIGTERM, &action, NULL);
  (void)signal(SIGPIPE, SIG_IGN);
}

static int fail(const problem *p) {
  fprintf(stderr, "vista-fly: %s\n", p->line);
  return EXIT_INPUT;
}

static int fly(const options *o) {
  problem p = {0};
  flight *const f = calloc(1, sizeof *f);
  if (f == NULL) return fail(&(problem){"system: out of memory"});
  const bool open = flight_open(f, o, &p);
  watch_signals();
  const bool done = open && flight_run(f, &interrupted, &p);
  if (open) flight_print(f);
  flight_close(f);
  free(f);
  if (!done) return fail(&p);
  if (!atomic_load(&interrupted)) return EXIT_SUCCESS;
  fprintf(stderr, "vista-fly: interrupted\n");
  return EXIT_INTERRUPTED;
}

int main(int argc, char **argv) {
  options o;
  problem p = {0};
  if (!options_parse(argc, argv, &o, &p)) return fail(&p);
  if (o.want == OPTIONS_VERSION) return printf("vista-fly %s\n", vista_version()) > 0 ? EXIT_SUCCESS : EXIT_INPUT;
  if (o.want == OPTIONS_HELP) return fputs(options_help, stdout) >= 0 ? EXIT_SUCCESS : EXIT_INPUT;
  return fly(&o);
}
