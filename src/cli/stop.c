/* Ctrl-C and its like. A signal first asks the library to end, through the callback of progress. What does not listen
 * is ended a moment later all the same: files that are being written have no name yet, so nothing is left of them.
 */
#define _XOPEN_SOURCE 700 /* sigaction, setitimer */

#include "cli/command.h"

#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

enum { SIGNALS = 4, TEXT = 640, PATIENCE = 100000 /* microseconds */ };
static const int asks[SIGNALS] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};

/* What is said at the end, ready to be written by a signal handler: one text is shown, the other one is prepared. */
static struct {
    volatile sig_atomic_t signal, shown;
    int ending; /* by end_now, in some thread */
    char text[2][TEXT];
    char name[64], what[32], outcome[TEXT / 2];
    int percent; /* below 0: not known */
    bool quiet;
} stop = {.percent = -1};

static void prepare(void)
{
    char *to = stop.text[!stop.shown], share[32] = "";
    if (stop.percent >= 0)
        snprintf(share, sizeof share, ", after %d %%", stop.percent);
    snprintf(to, TEXT, "%s%s: stopped while %s%s%s%s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "", stop.name, stop.what,
             share, *stop.outcome ? "; " : "", stop.outcome);
    stop.shown = !stop.shown;
}

/* Say what was done, and end as the signal would have ended the program. Safe in a signal handler. */
static void end_now(void)
{
    const int signal = stop.signal;
    const struct sigaction usual = {.sa_handler = SIG_DFL};
    sigset_t open;
    const struct itimerval never = {.it_value = {.tv_usec = 0}};
    setitimer(ITIMER_REAL, &never, NULL);
    const bool second = __atomic_exchange_n(&stop.ending, 1, __ATOMIC_SEQ_CST);
    if (second) /* the alarm came to this thread while another one ends, and speaks; if it can't, this one ends */
        poll(NULL, 0, PATIENCE / 1000);
    const char *text = stop.text[stop.shown];
    static const char over[] = "kage: the time of --max-seconds is over\n";
    if (!second && !stop.quiet && write(STDERR_FILENO, text, strlen(text)) < 0)
        stop.quiet = true;   /* nobody listens */
    if (signal == SIGALRM) { /* of stop_after */
        const ssize_t said = second ? 0 : write(STDERR_FILENO, over, sizeof over - 1);
        (void)said;
        _exit(EXIT_TIME);
    }
    sigaction(signal, &usual, NULL);
    sigemptyset(&open);
    sigaddset(&open, signal);
    sigprocmask(SIG_UNBLOCK, &open, NULL);
    kill(getpid(), signal);
    pause();
}

static void on_signal(int signal)
{
    const struct itimerval wait = {.it_value = {.tv_usec = PATIENCE}};
    if (stop.signal) /* a second one */
        end_now();
    stop.signal = signal;
    setitimer(ITIMER_REAL, &wait, NULL);
}

static void on_alarm(int signal)
{
    if (stop.signal)
        end_now();
    on_signal(signal); /* the time of stop_after */
}

void stop_after(double seconds)
{
    const double whole = floor(seconds);
    const struct itimerval wait = {
        .it_value = {.tv_sec = (time_t)whole, .tv_usec = (suseconds_t)fmax((seconds - whole) * 1e6, 1)}};
    if (seconds > 0)
        setitimer(ITIMER_REAL, &wait, NULL);
}

void stop_begin(const char *name, bool quiet)
{
    struct sigaction ask = {.sa_handler = on_signal, .sa_flags = SA_RESTART}, late, before;
    const struct sigaction ignore = {.sa_handler = SIG_IGN};
    snprintf(stop.name, sizeof stop.name, "%s", name);
    snprintf(stop.what, sizeof stop.what, "reading");
    stop.quiet = quiet;
    prepare();
    sigemptyset(&ask.sa_mask);
    for (int k = 0; k < SIGNALS; k++)
        sigaddset(&ask.sa_mask, asks[k]);
    late = ask;
    late.sa_handler = on_alarm;
    sigaction(SIGALRM, &late, NULL);
    sigaction(SIGXFSZ, &ignore, NULL); /* a file that grows too large is an error of its own */
    for (int k = 0; k < SIGNALS; k++) {
        sigaction(asks[k], NULL, &before);
        if (before.sa_handler != SIG_IGN) /* as under nohup */
            sigaction(asks[k], &ask, NULL);
    }
}

bool stop_asked(void) { return stop.signal != 0; }

void stop_note(const char *what, double share)
{
    const int percent = (int)(100 * share);
    if (strcmp(what, "objects") == 0)
        what = "reading";
    if (stop_asked() || (percent == stop.percent && strcmp(what, stop.what) == 0))
        return;
    snprintf(stop.what, sizeof stop.what, "%.31s", what);
    stop.percent = percent;
    prepare();
}

void stop_outcome(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    vsnprintf(stop.outcome, sizeof stop.outcome, fmt, args);
    va_end(args);
    prepare();
}

void stop_end(void)
{
    if (stop_asked())
        end_now();
}
