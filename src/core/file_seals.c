/* Seals of HDF5 files: a digest of their bytes, behind the end of what HDF5 reads. HDF5 cuts the
   seal off when it writes to the file. src/core/file_seals.f90 describes the functions. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Places are those of a superblock from version 2 on. */
enum { block_size = 1 << 20, version_at = 8, end_at = 28 };

struct seal {
   char letters[8];
   uint64_t digest;   /* of all bytes before the seal */
};

static const char seal_letters[8] = {'t', 'h', 'e', 'r', 'c', 'o', 'n', '\n'};
static const char hdf5_signature[8] = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};

/* Reads bytes at a position; 0, or the error number. */
static int read_at(int descriptor, off_t position, void *bytes, size_t count)
{
   char *next = bytes;

   while (count > 0) {
      ssize_t portion = pread(descriptor, next, count, position);

      if (portion < 0 && errno == EINTR)
         continue;
      if (portion <= 0)
         return portion < 0 ? errno : EIO;
      next += portion;
      position += portion;
      count -= (size_t)portion;
   }
   return 0;
}

/* A digest of the first bytes of a file. Each step is one-to-one, so that a change within one word
   is never overlooked; one of several words is with a probability of 2^-64. */
static int digest_of(int descriptor, off_t count, uint64_t *digest)
{
   uint64_t *block = malloc(block_size);
   int number = block ? 0 : ENOMEM;

   *digest = (uint64_t)count;
   for (off_t position = 0; number == 0 && position < count; position += block_size) {
      size_t length = count - position < block_size ? (size_t)(count - position) : block_size;
      size_t words = (length + sizeof *block - 1)/sizeof *block;

      block[words - 1] = 0;
      number = read_at(descriptor, position, block, length);
      for (size_t i = 0; i < words; i++) {
         *digest = (*digest ^ block[i])*0x9E3779B97F4A7C15u;
         *digest ^= *digest >> 32;
      }
   }
   free(block);
   return number;
}

int file_seal(const char *path)
{
   struct seal seal;
   struct stat status;
   int descriptor = open(path, O_RDWR | O_CLOEXEC), number = 0;

   if (descriptor < 0)
      return errno;
   memcpy(seal.letters, seal_letters, sizeof seal.letters);
   if (fstat(descriptor, &status) != 0)
      number = errno;
   if (number == 0)
      number = digest_of(descriptor, status.st_size, &seal.digest);
   errno = ENOSPC;   /* where fewer bytes are written */
   if (number == 0 && pwrite(descriptor, &seal, sizeof seal, status.st_size) != sizeof seal)
      number = errno;
   return close(descriptor) != 0 && number == 0 ? errno : number;
}

/* A file without a seal is one of an earlier version or written to by another program, and ends
   where its superblock says. What has no superblock is left to HDF5, which refuses it. */
int file_is_damaged(const char *path)
{
   struct seal seal;
   struct stat status;
   uint64_t digest, end;
   unsigned char superblock[end_at + sizeof end];
   off_t sealed;
   int descriptor = open(path, O_RDONLY | O_CLOEXEC), damaged = 0;

   if (descriptor >= 0 && fstat(descriptor, &status) == 0
      && read_at(descriptor, 0, superblock, sizeof superblock) == 0) {
      sealed = status.st_size - (off_t)sizeof seal;
      memcpy(&end, superblock + end_at, sizeof end);
      if (read_at(descriptor, sealed, &seal, sizeof seal) == 0
         && memcmp(seal.letters, seal_letters, sizeof seal.letters) == 0)
         damaged = digest_of(descriptor, sealed, &digest) != 0 || digest != seal.digest;
      else
         damaged = memcmp(superblock, hdf5_signature, sizeof hdf5_signature) == 0
            && superblock[version_at] >= 2 && end != (uint64_t)status.st_size;
   }
   if (descriptor >= 0)
      close(descriptor);
   return damaged;
}
