/* How much memory the system lets the process have. src/core/memory_calls.f90 describes it. */
#define _GNU_SOURCE
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <unistd.h>

/* Address space of the process beyond its resident memory, in bytes. */
static double unused_address_space(void)
{
   long size = 0, resident = 0;
   FILE *file = fopen("/proc/self/statm", "r");

   if (file) {
      if (fscanf(file, "%ld %ld", &size, &resident) != 2)
         size = resident = 0;
      fclose(file);
   }
   return (double)(size - resident) * (double)sysconf(_SC_PAGESIZE);
}

/* Takes a limit where it is less than the one so far. */
static void take_least(double bytes, const char *words, double *least, char *source, int length)
{
   if (bytes >= *least)
      return;
   *least = bytes;
   snprintf(source, (size_t)length, "%s", words);
}

/* The number in a file of a control group, for the group and all groups above it. */
static void take_group(const char *mount, char *group, const char *name, double *least,
   char *source, int length)
{
   char path[PATH_MAX + 64];
   double bytes;
   char *slash;

   do {
      FILE *file;

      snprintf(path, sizeof path, "%s%s/%s", mount, group, name);
      file = fopen(path, "r");
      if (file) {
         /* "max" is no number. */
         if (fscanf(file, "%lf", &bytes) == 1)
            take_least(bytes, name, least, source, length);
         fclose(file);
      }
      slash = strrchr(group, '/');
      if (slash)
         *slash = 0;
   } while (slash);
}

/* The least of the limits on resident memory [byte], and in words which one it is. */
double memory_limit(char *source, int length)
{
   double least = 1e300;
   struct rlimit limit;
   struct sysinfo machine;
   char line[PATH_MAX + 64], *group;
   FILE *groups = fopen("/proc/self/cgroup", "r");

   source[0] = 0;
   if (sysinfo(&machine) == 0)
      take_least(((double)machine.totalram + (double)machine.totalswap) * machine.mem_unit,
         "this machine", &least, source, length);
   while (groups && fgets(line, sizeof line, groups)) {
      line[strcspn(line, "\n")] = 0;
      if (strncmp(line, "0::", 3) == 0)
         take_group("/sys/fs/cgroup", line + 3, "memory.max", &least, source, length);
      else if ((group = strstr(line, ":memory:")))
         take_group("/sys/fs/cgroup/memory", group + 8, "memory.limit_in_bytes", &least, source,
            length);
   }
   if (groups)
      fclose(groups);
   if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      take_least((double)limit.rlim_cur - unused_address_space(), "ulimit -v", &least, source,
         length);
   return least;
}

/* Lets the stack grow to so many bytes, as far as the hard limit allows; returns what it may have.
 * The system looks at the limit whenever the stack grows. */
double memory_allow_stack(double bytes)
{
   const rlim_t wanted = (rlim_t)bytes;
   struct rlimit limit;

   if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= wanted)
      return bytes;
   limit.rlim_cur = limit.rlim_max < wanted ? limit.rlim_max : wanted;
   setrlimit(RLIMIT_STACK, &limit);
   getrlimit(RLIMIT_STACK, &limit);
   return (double)limit.rlim_cur;
}
