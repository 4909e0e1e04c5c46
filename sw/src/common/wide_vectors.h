/* Marks of loops over pixels that compilers turn into vectors, internal to libvista. */
#ifndef VISTA_SRC_WIDE_VECTORS_H
#define VISTA_SRC_WIDE_VECTORS_H

#include <limits.h> /* tells whether the C library is glibc */

/* A function compiled twice, for any x86-64 and for one with AVX2; the loader takes what the processor has. The results
 * are the same: no operation differs. Sanitizers cannot instrument what runs while libraries are loaded. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__AVX2__)
#define VISTA_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define VISTA_WIDE_VECTORS
#endif

#endif
