/* What the program asks of the file system beyond Fortran's own statements. Functions return 0 or
   the system's error number; src/core/file_calls.f90 describes them. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { locked_by_another = -1, not_lockable = -2, too_long = -3, block_size = 1 << 20 };
enum { most_working = 4, longest_path = 4096 };

/* Paths of the working files that this process has made, and its number. */
static char working[most_working][longest_path];
static pid_t worker;

/* Number of the first error on standard output. */
static int standard_output_error = 0;

/* Text of an error number, cut to the buffer. */
void file_reason(int number, char *text, int length)
{
   snprintf(text, (size_t)length, "%s", strerror(number));
}

int file_rename(const char *from, const char *to)
{
   return rename(from, to) == 0 ? 0 : errno;
}

/* Waits until a file is on its disk, where the system can tell. */
int file_sync(const char *path)
{
   int descriptor = open(path, O_RDONLY | O_CLOEXEC);
   int number = descriptor >= 0 && fsync(descriptor) == 0 ? 0 : errno;

   if (descriptor >= 0)
      close(descriptor);
   return number;
}

int file_make_folder(const char *path)
{
   return mkdir(path, 0777) == 0 || errno == EEXIST ? 0 : errno;
}

/* Whether files can be made in a folder, whose path ends with a slash. */
int file_check_folder(const char *path)
{
   return access(path, W_OK | X_OK) == 0 ? 0 : errno;
}

/* Writes all of the bytes; signal handlers may call it. */
int file_write_all(int descriptor, const char *bytes, size_t count)
{
   while (count > 0) {
      ssize_t written = write(descriptor, bytes, count);
      if (written < 0 && errno == EINTR)
         continue;
      if (written < 0)
         return errno;
      bytes += written;
      count -= (size_t)written;
   }
   return 0;
}

/* Prints text on standard output at once; that it finds no room is remembered, that nobody reads
 * it any more is not. */
void file_print(const char *text, long count)
{
   int number = file_write_all(STDOUT_FILENO, text, (size_t)count);

   if (standard_output_error == 0 && number != EPIPE)
      standard_output_error = number;
}

int file_print_error(void)
{
   return standard_output_error;
}

/* Whether a file can be read once only, as a pipe. */
int file_is_stream(const char *path)
{
   struct stat status;

   return stat(path, &status) == 0 && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode)
      || S_ISCHR(status.st_mode));
}

/* Whether a file can be written: 0 or the reason why not. It is left as it was. */
int file_try(const char *path)
{
   int is_new = access(path, F_OK) != 0;
   int descriptor = open(path, O_WRONLY | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0666);

   if (descriptor < 0)
      return errno;
   close(descriptor);
   if (is_new)
      unlink(path);
   return 0;
}

/* Whether a file, which is there, takes so many more bytes: 0 or the reason why not. */
int file_try_growth(const char *path, long count)
{
   int number = 0, descriptor = open(path, O_WRONLY | O_APPEND | O_CLOEXEC);
   char *bytes = calloc(1, (size_t)count);

   if (descriptor < 0 || !bytes)
      number = errno;
   else
      number = file_write_all(descriptor, bytes, (size_t)count);
   if (descriptor >= 0 && close(descriptor) != 0 && number == 0)
      number = errno;
   free(bytes);
   return number;
}

/* Notes a working file, unless it is noted: one that was renamed has its name again later. */
static void note_working(const char *path)
{
   int i;

   if (worker != getpid())
      memset(working, 0, sizeof working);
   worker = getpid();
   for (i = 0; i < most_working && working[i][0] && strcmp(working[i], path) != 0; i++)
      ;
   if (i < most_working && strlen(path) < longest_path)
      strcpy(working[i], path);
}

/* Removes the working files of this process, from within a handler, too. */
void file_remove_own_working(void)
{
   for (int i = 0; i < most_working && worker == getpid(); i++)
      if (working[i][0])
         unlink(working[i]);
}

/* Makes a new file `stem.<process>.tmp`, where such a file is not there yet, else with the next
   free number; its path goes to `path`, which has room for it. */
int file_create_working(const char *stem, char *path, int length)
{
   for (long number = (long)getpid();; number++) {
      int descriptor;

      snprintf(path, (size_t)length, "%s.%ld.tmp", stem, number);
      descriptor = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor >= 0) {
         note_working(path);
         return close(descriptor) == 0 ? 0 : errno;
      }
      if (errno != EEXIST)
         return errno;
   }
}

/* Whether a file begins as HDF5 files do, with their signature or a hole, or is empty. */
static int may_be_result(int folder, const char *name)
{
   char first = 0;
   int descriptor = openat(folder, name, O_RDONLY | O_CLOEXEC);

   if (descriptor < 0 || read(descriptor, &first, 1) < 0)
      first = 'x';
   if (descriptor >= 0)
      close(descriptor);
   return first == 0 || first == '\x89';
}

/* Removes the results `stem.<number>.tmp`, which runs left that were killed. */
int file_remove_working(const char *stem)
{
   const char *slash = strrchr(stem, '/');
   const char *name = slash ? slash + 1 : stem;
   size_t length = strlen(name);
   char *folder = slash ? strndup(stem, (size_t)(slash - stem + 1)) : strdup("./");
   DIR *entries = folder ? opendir(folder) : NULL;
   struct dirent *entry;

   while (entries && (entry = readdir(entries))) {
      const char *rest = entry->d_name + length + 1;

      if (strncmp(entry->d_name, name, length) != 0 || entry->d_name[length] != '.')
         continue;
      if (strspn(rest, "0123456789") > 0 && strcmp(rest + strspn(rest, "0123456789"), ".tmp") == 0
         && may_be_result(dirfd(entries), entry->d_name))
         unlinkat(dirfd(entries), entry->d_name, 0);
   }
   if (entries)
      closedir(entries);
   free(folder);
   return 0;
}

/* Device and inode of a regular file; zeros where there is none. */
void file_identity(const char *path, long identity[2])
{
   struct stat status;
   int is_there = stat(path, &status) == 0 && S_ISREG(status.st_mode);

   identity[0] = is_there ? (long)status.st_dev : 0;
   identity[1] = is_there ? (long)status.st_ino : 0;
}

/* Makes a file anew. */
int file_open_new(const char *path, int *descriptor)
{
   *descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
   return *descriptor < 0 ? errno : 0;
}

/* Opens a file, which is made where it is missing and otherwise left as it is, and locks it until its
   descriptor is closed or the process ends. Where the file system has no locks the file is open all
   the same. */
int file_lock(const char *path, int *descriptor)
{
   struct stat status;

   do {
      *descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (*descriptor < 0)
         return errno;
      if (flock(*descriptor, LOCK_EX | LOCK_NB) != 0) {
         int number = errno;

         if (number == EOPNOTSUPP || number == ENOLCK || number == ENOSYS)
            return not_lockable;
         close(*descriptor);
         *descriptor = -1;
         return number == EWOULDBLOCK ? locked_by_another : number;
      }
      /* Another run may have removed the file since it was opened. */
      if (fstat(*descriptor, &status) == 0 && status.st_nlink > 0)
         return 0;
      close(*descriptor);
   } while (1);
}

/* Ends a lock; a file in which nothing was written is removed. */
void file_unlock(const char *path, int descriptor)
{
   struct stat status;

   if (fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && status.st_size == 0)
      unlink(path);
   close(descriptor);
}

/* Writes over what is at a position of a file; at its end, where the position is negative. */
int file_write(int descriptor, long position, const char *text, long count)
{
   const int from = position < 0 ? SEEK_END : SEEK_SET;

   if (lseek(descriptor, position < 0 ? 0 : position, from) < 0 && errno != ESPIPE)
      return errno;
   return file_write_all(descriptor, text, (size_t)count);
}

int file_empty(int descriptor)
{
   /* What is no regular file, such as a device, has nothing to be cut off. */
   return ftruncate(descriptor, 0) == 0 || errno == EINVAL ? 0 : errno;
}

/* Copies a file over another one. */
int file_copy(const char *from, const char *to, int *is_source)
{
   int source = open(from, O_RDONLY | O_CLOEXEC), target, number = 0;
   char *block = malloc(block_size);
   ssize_t count = 0;

   *is_source = source < 0 || !block;
   target = *is_source ? -1 : open(to, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
   if (*is_source || target < 0)
      number = errno;
   while (number == 0 && (count = read(source, block, block_size)) > 0)
      number = file_write_all(target, block, (size_t)count);
   if (count < 0) {
      number = errno;
      *is_source = 1;
   }
   if (target >= 0 && close(target) != 0 && number == 0)
      number = errno;
   if (source >= 0)
      close(source);
   free(block);
   return number;
}

/* Reads a file, which may be a pipe, to its end; the caller frees the contents. */
int file_read(const char *path, long most, char **contents, long *count)
{
   int number = 0, descriptor = open(path, O_RDONLY | O_CLOEXEC);
   size_t room = block_size;
   ssize_t portion;

   *count = 0;
   *contents = malloc(room);
   if (descriptor < 0 || !*contents)
      number = errno;
   while (number == 0) {
      portion = read(descriptor, *contents + *count, room - (size_t)*count);
      if (portion < 0 && errno == EINTR)
         continue;
      if (portion < 0)
         number = errno;
      if (portion <= 0)
         break;
      *count += portion;
      if (*count > most)
         number = too_long;
      else if ((size_t)*count == room) {
         char *more = realloc(*contents, room *= 2);

         if (!more)
            number = errno;
         else
            *contents = more;
      }
   }
   if (descriptor >= 0)
      close(descriptor);
   if (number != 0) {
      free(*contents);
      *contents = NULL;
   }
   return number;
}

/* A file that would grow past the limit of the process is an error like others, no reason to die. */
void file_survive_limits(void)
{
   signal(SIGXFSZ, SIG_IGN);
}
