// The one annotation that lets a plain function compile for host and device.
#pragma once

#if defined(__CUDACC__)
#define ISOSHELL_HD __host__ __device__
#else
#define ISOSHELL_HD
#endif
