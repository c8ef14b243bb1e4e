// Functions that are compiled for machines with and without wide vectors; the machine chooses when the program starts.
#pragma once

#include "voxel/always_inline.h"

#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12 && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define ISOSHELL_VECTOR_VERSIONS __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define ISOSHELL_VECTOR_VERSIONS
#endif
