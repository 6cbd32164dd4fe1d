/* Seals of HDF5 files: a digest of their bytes, behind the end of what HDF5 reads. HDF5 cuts the
   seal off when it writes to the file. src/core/file_calls.f90 describes the functions. */
#define _GNU_SOURCE
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Places are those of a superblock from version 2 on. */
enum { block_size = 1 << 20, version_at = 8, end_at = 28 };

struct seal {
   char letters[8];
   uint64_t digest;   /* of all bytes before the seal */
};

static const char seal_letters[8] = {'t', 'h', 'e', 'r', 'c', 'o', 'n', '\n'};
static const char hdf5_signature[8] = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};

/* A digest of the first bytes of a file. Each step is one-to-one, so that a change within one word
   is never overlooked; one of several words is with a probability of 2^-64. */
static int digest_of(FILE *file, long count, uint64_t *digest)
{
   uint64_t *block = malloc(block_size);
   int number = block ? 0 : ENOMEM;

   *digest = (uint64_t)count;
   rewind(file);
   for (long left = count; number == 0 && left > 0; left -= block_size) {
      size_t length = left < block_size ? (size_t)left : block_size;
      size_t words = (length + sizeof *block - 1)/sizeof *block;

      block[words - 1] = 0;
      if (fread(block, 1, length, file) != length)
         number = EIO;
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
   FILE *file = fopen(path, "r+e");
   int number;

   if (!file)
      return errno;
   memcpy(seal.letters, seal_letters, sizeof seal.letters);
   number = fseek(file, 0, SEEK_END) != 0 ? errno : digest_of(file, ftell(file), &seal.digest);
   if (number == 0 && (fseek(file, 0, SEEK_END) != 0 || fwrite(&seal, sizeof seal, 1, file) != 1))
      number = errno;
   return fclose(file) != 0 && number == 0 ? errno : number;
}

/* A file without a seal is one of an earlier version or written to by another program, and ends
   where its superblock says. What has no superblock is left to HDF5, which refuses it. */
int file_is_damaged(const char *path)
{
   struct seal seal;
   uint64_t digest, end;
   unsigned char superblock[end_at + sizeof end];
   FILE *file = fopen(path, "re");
   int damaged = 0;

   if (file && fread(superblock, sizeof superblock, 1, file) == 1
      && fseek(file, -(long)sizeof seal, SEEK_END) == 0) {
      const long sealed = ftell(file);

      memcpy(&end, superblock + end_at, sizeof end);
      if (fread(&seal, sizeof seal, 1, file) == 1
         && memcmp(seal.letters, seal_letters, sizeof seal.letters) == 0)
         damaged = digest_of(file, sealed, &digest) != 0 || digest != seal.digest;
      else
         damaged = memcmp(superblock, hdf5_signature, sizeof hdf5_signature) == 0
            && superblock[version_at] >= 2 && end != (uint64_t)sealed + sizeof seal;
   }
   if (file)
      fclose(file);
   return damaged;
}
