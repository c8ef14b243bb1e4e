// For small functions that loops over lanes are made of: a loop with a call in it is not made into vectors, and a clone
// of a function for wider vectors (core/vector_versions.h) only takes in what is inlined.
#pragma once

#define ISOSHELL_INLINE inline __attribute__((always_inline))
