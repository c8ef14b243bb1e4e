# What devices the CUDA backend is compiled for, unless CMAKE_CUDA_ARCHITECTURES says it: those of this machine, or where
# it has none, or with ISOSHELL_CUDA_FOR_ALL, all that are supported: machine code for Turing, Ampere (Ada runs it too) and
# Hopper, and PTX for later chips. Every toolkit from 12.0 on knows these. One architecture takes a third of the time.
if(DEFINED CMAKE_CUDA_ARCHITECTURES OR ISOSHELL_CUDA STREQUAL "off")
  return()
endif()
set(CMAKE_CUDA_ARCHITECTURES 75-real 80-real 90)
find_program(ISOSHELL_NVIDIA_SMI nvidia-smi)
mark_as_advanced(ISOSHELL_NVIDIA_SMI)
if(ISOSHELL_CUDA_FOR_ALL OR NOT ISOSHELL_NVIDIA_SMI)
  return()
endif()
execute_process(COMMAND ${ISOSHELL_NVIDIA_SMI} --query-gpu=compute_cap --format=csv,noheader
                OUTPUT_VARIABLE found ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
string(REPLACE "." "" found "${found}")
string(REPLACE "\n" ";" found "${found}")
list(REMOVE_DUPLICATES found)
list(FILTER found INCLUDE REGEX "^[0-9]+$")
if(found)
  set(CMAKE_CUDA_ARCHITECTURES ${found})
endif()
