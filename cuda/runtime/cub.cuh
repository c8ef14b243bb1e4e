// CUB's algorithms. No other file includes CUB: what stands before its headers here must stand before all of them.
//
// DeviceMergeSort of CUB 2.8 to 3.0 (CUDA 12.9 and 13.0) launches its merge kernel as a programmatic dependent of the
// kernel that finds the partitions, and reads the partitions before it waits for that kernel (NVIDIA/cccl issue 5297,
// repaired by pull request 5456). On a busy device it then merges by what lay in the scratch memory before: wrong
// orders, writes anywhere, illegal instructions. Without programmatic dependent launch every kernel waits for the one
// before.
#pragma once

#include <cub/version.cuh>
#if CUB_VERSION >= 200800 && CUB_VERSION < 300100
#include <cuda/std/__cccl/cuda_capabilities.h>
#undef _CCCL_HAS_PDL
#define _CCCL_HAS_PDL 0
#endif

#include <cub/device/device_merge_sort.cuh>
#include <cub/device/device_radix_sort.cuh>
