/* Loaded before a program, makes its clocks show the processor time of the thread that asks: what other programs take does not count. */
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int clock_gettime(clockid_t clock, struct timespec *time)
{
    int shown = clock == CLOCK_MONOTONIC || clock == CLOCK_REALTIME;
    return (int)syscall(SYS_clock_gettime, shown ? CLOCK_THREAD_CPUTIME_ID : clock, time);
}
