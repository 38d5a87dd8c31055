#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>

#include "extrados.h"

enum { NOT_ASKED, ASKED, HEARD };
static atomic_int flag;

void extrados_cancel_set(int value) {
    int before = NOT_ASKED;
    if (value)
        atomic_compare_exchange_strong(&flag, &before, ASKED); /* what was heard is not asked again */
    else
        atomic_store(&flag, NOT_ASKED);
}

int extrados_cancel_get(void) {
    int now = atomic_load_explicit(&flag, memory_order_relaxed);
    if (now == ASKED) atomic_compare_exchange_strong(&flag, &now, HEARD);
    return now != NOT_ASKED;
}

int extrados_cancel_unheard(void) { return atomic_load(&flag) == ASKED; }

static const int watched[] = {SIGINT, SIGTERM};
enum { WATCHED = sizeof watched / sizeof *watched };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int watchers;
static struct sigaction before[WATCHED];

/* Asks the running loops to stop, then does what would have been done without it. */
static void on_signal(int number, siginfo_t *info, void *context) {
    for (int k = 0; k < WATCHED; k++) {
        if (watched[k] != number) continue;
        if (before[k].sa_flags & SA_SIGINFO) {
            extrados_cancel_set(1);
            before[k].sa_sigaction(number, info, context);
        } else if (before[k].sa_handler == SIG_DFL) { /* the process ends by the signal */
            signal(number, SIG_DFL);
            raise(number);
        } else if (before[k].sa_handler != SIG_IGN) {
            extrados_cancel_set(1);
            before[k].sa_handler(number);
        }
    }
}

/* A handler of somebody else's that has been put in the place of ours since stays. */
static int is_ours(int number, struct sigaction *now) {
    sigaction(number, NULL, now);
    return (now->sa_flags & SA_SIGINFO) && now->sa_sigaction == on_signal;
}

void extrados_watch_signals(int on) {
    pthread_mutex_lock(&lock);
    watchers += on ? 1 : -1;
    for (int k = 0; k < WATCHED; k++) {
        struct sigaction now;
        int ours = is_ours(watched[k], &now);
        if (on && !ours) {
            struct sigaction mine = {.sa_sigaction = on_signal, .sa_flags = SA_SIGINFO | SA_ONSTACK};
            sigemptyset(&mine.sa_mask);
            before[k] = now;
            sigaction(watched[k], &mine, NULL);
        } else if (watchers == 0 && ours) {
            sigaction(watched[k], &before[k], NULL);
        }
    }
    pthread_mutex_unlock(&lock);
}
