/* Children, signals and memory that runs out: what needs the system's headers, which Fortran
 * cannot read. Interfaces: processes.f90, interruption.f90, ordering.f90 in linalg.
 *
 * A run may have to end within an increment: because a signal came, or because there is no memory
 * left. A signal handler may then call nothing but what POSIX.1-2017, 2.4.3 allows in one (write,
 * pwrite, unlink, strcpy, signal, alarm, _exit), so that all words are prepared before. */
#define _GNU_SOURCE

#include <errno.h>
#include <fcntl.h>
#include <metis.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { longest = 4096 };                              /* characters of a path or a sentence */
enum { status_internal = 3, status_interrupted = 5 }; /* of module errors */
enum { at_once = 1, after_grace = 2 };                /* of module interruption */
enum { grace = 2, rest = 2 };   /* seconds of an increment after a signal: to its end, to the run's */

/* report_type of the module; what a child says of itself */
struct report {
   int is_whole, lacks_memory, status, increments, iterations, verify_passed, verify_failed, files;
   double seconds;
   char reason[longest];
};

/* process_end_type of the module */
struct process_end {
   int status, signal, is_crash;
   char signal_name[16];
   double cpu_seconds, peak_bytes;
};

static volatile sig_atomic_t caught, times, is_overdue, ends;
static char deck[longest], where[longest], leftover[longest];
static int shows_progress, report_file = -1;
static struct report filed;   /* what a child has reported */

/* As fork. What the child prints and reports goes into files that have no name, so that nothing
 * of them is left when both have ended. The child never outlives its parent. */
int thercon_start_child(int *messages, int *report)
{
   const pid_t parent = getpid();
   pid_t child;

   *messages = memfd_create("messages", MFD_CLOEXEC);
   *report = memfd_create("report", MFD_CLOEXEC);
   if (*messages < 0 || *report < 0) return -1;
   signal(SIGCHLD, SIG_DFL); /* a caller that ignores it would have the ends of children lost */
   child = fork();
   if (child != 0) return child;
   /* The parent may have ended before the first call. */
   if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent || dup2(*messages, 1) < 0 ||
      dup2(*messages, 2) < 0) _exit(status_internal);
   report_file = *report;
   return 0;
}

/* Whether a child has ended, and how; waits for that where it is asked to. */
int thercon_collect_child(int child, int waits, struct process_end *end)
{
   struct rusage usage;
   const char *name;
   pid_t ended;
   int status;

   do ended = wait4(child, &status, waits ? 0 : WNOHANG, &usage);
   while (ended < 0 && errno == EINTR);
   if (ended != child) return 0;
   end->signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
   end->status = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
   end->is_crash = end->signal == SIGSEGV || end->signal == SIGBUS || end->signal == SIGFPE ||
      end->signal == SIGILL || end->signal == SIGABRT;
   name = sigabbrev_np(end->signal);
   if (name) snprintf(end->signal_name, sizeof end->signal_name, "SIG%s", name);
   else snprintf(end->signal_name, sizeof end->signal_name, "signal %d", end->signal);
   end->cpu_seconds = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
      1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
   end->peak_bytes = 1024.0 * (double)usage.ru_maxrss;
   return 1;
}

/* Passes the signal that came on to a child, or ends it at once. */
void thercon_signal_child(int child, int kills) { kill(child, kills ? SIGKILL : caught); }

/* A child files its report over the one before; in the first process nothing is done. */
void thercon_file_report(const struct report *report)
{
   filed = *report;
   if (report_file >= 0) (void)!pwrite(report_file, &filed, sizeof filed, 0);
}

/* Memory, all zeros, that this process shares with its later children until it ends; or NULL. */
void *thercon_share(size_t bytes)
{
   void *shared = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
   return shared == MAP_FAILED ? NULL : shared;
}

/* In file_calls.c. */
int file_write_all(int descriptor, const char *bytes, size_t count);
void file_remove_own_working(void);

static void put(int file, const char *words) { file_write_all(file, words, strlen(words)); }

/* Says why in one line, removes the files that are left over and ends the process. */
static _Noreturn void end_run(int status, const char *reason)
{
   filed.is_whole = 1;
   filed.status = status;
   strcpy(filed.reason, reason);
   if (strlen(reason) + strlen(where) < sizeof filed.reason) strcat(filed.reason, where);
   signal(SIGPIPE, SIG_IGN);
   if (shows_progress) put(2, "\r\033[K");
   put(2, deck[0] ? deck : "thercon");
   put(2, ": error: ");
   put(2, filed.reason);
   put(2, "\n");
   if (leftover[0]) unlink(leftover);
   file_remove_own_working();
   if (report_file >= 0) (void)!pwrite(report_file, &filed, sizeof filed, 0);
   _exit(status);
}

static _Noreturn void end_by_signal(void)
{
   end_run(status_interrupted, caught == SIGINT ? "ended by SIGINT" : "ended by SIGTERM");
}

static void take_signal(int number)
{
   caught = number;
   times = times + 1;
   if (ends == at_once) end_by_signal();
   if (shows_progress && times == 1) put(2, "\r\033[Kending after this increment");
   if (ends != 0 && times == 1) alarm(grace);
}

static void take_alarm(int number)
{
   (void)number;
   if (ends != 0 && is_overdue) end_by_signal();
   is_overdue = 1;
   alarm(rest);
}

static void handle(int number, void (*handler)(int))
{
   struct sigaction action = {0}, former;

   sigaction(number, NULL, &former);
   if (former.sa_handler == SIG_IGN) return; /* as nohup has it, and shells for their background */
   action.sa_handler = handler;
   action.sa_flags = SA_RESTART;
   sigfillset(&action.sa_mask);
   sigaction(number, &action, NULL);
}

/* From now on SIGINT and SIGTERM are remembered, and, where it is asked for, writing to a pipe
 * that nobody reads is an error of the statement only. */
void thercon_catch_signals(int outlives_pipes)
{
   signal(SIGALRM, SIG_DFL);
   handle(SIGALRM, take_alarm);
   handle(SIGINT, take_signal);
   handle(SIGTERM, take_signal);
   if (outlives_pipes) signal(SIGPIPE, SIG_IGN);
}

int thercon_caught(void) { return caught == 0 ? 0 : caught == SIGINT ? 1 : 2; }

int thercon_caught_times(void) { return times; }

int thercon_is_overdue(void) { return is_overdue; }

static void take_words(char *buffer, const char *words)
{
   buffer[0] = 0;
   if (strlen(words) < longest) strcpy(buffer, words);
}

/* When a signal may end the run from now on, and what is then to be said and removed. */
void thercon_prepare_end(int when, int shows, const char *deck_path, const char *where_words,
   const char *leftover_path)
{
   sigset_t all, before;

   sigfillset(&all);
   sigprocmask(SIG_SETMASK, &all, &before);
   take_words(deck, deck_path);
   take_words(where, where_words);
   take_words(leftover, leftover_path);
   shows_progress = shows;
   ends = when;
   if (caught != 0 && ends == at_once) end_by_signal();
   sigprocmask(SIG_SETMASK, &before, NULL);
}

/* METIS_NodeND of a graph, with default options. While METIS works it has handlers of its own for
 * SIGTERM and SIGABRT, which leave it by longjmp from wherever it is, and the handlers that it puts
 * back would serve one signal only. So SIGTERM waits for its end, and both handlers are restored.
 * SIGABRT cannot wait: METIS raises it where it has no memory. */
int thercon_order_graph(idx_t vertices, idx_t *start, idx_t *neighbour, idx_t *order,
   idx_t *position)
{
   struct sigaction on_term, on_abort;
   sigset_t held, before;
   int status;

   sigemptyset(&held);
   sigaddset(&held, SIGTERM);
   sigprocmask(SIG_BLOCK, &held, &before);
   sigaction(SIGTERM, NULL, &on_term);
   sigaction(SIGABRT, NULL, &on_abort);
   status = METIS_NodeND(&vertices, start, neighbour, NULL, NULL, order, position);
   sigaction(SIGTERM, &on_term, NULL);
   sigaction(SIGABRT, &on_abort, NULL);
   sigprocmask(SIG_SETMASK, &before, NULL);
   return status;
}

/* Memory: the linker has the calls of the program itself and of archives in it, not those of shared
 * libraries, come here (--wrap). Fortran's ALLOCATE would end in a backtrace where there is no memory,
 * and arrays that the compiler makes in SIGSEGV. */
void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t bytes);
void *__real_realloc(void *address, size_t bytes);

_Noreturn void thercon_end_without_memory(double bytes)
{
   char words[80];

   snprintf(words, sizeof words, "memory ran out: %.0f MB more are not available", bytes / 1e6);
   filed.lacks_memory = 1;
   end_run(status_internal, words);
}

static void *checked(void *address, double bytes)
{
   if (address == NULL && bytes > 0.0) thercon_end_without_memory(bytes);
   return address;
}

void *__wrap_malloc(size_t bytes) { return checked(__real_malloc(bytes), (double)bytes); }

void *__wrap_calloc(size_t count, size_t bytes)
{
   return checked(__real_calloc(count, bytes), (double)count * (double)bytes);
}

/* gfortran asks for no bytes where an array is empty; what that frees, C leaves open. */
void *__wrap_realloc(void *former, size_t bytes)
{
   return checked(__real_realloc(former, bytes > 0 ? bytes : 1), (double)bytes);
}
