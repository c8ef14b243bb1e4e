# Finds NanoVDB, which is headers only (target NanoVDB::headers). Set NanoVDB_INCLUDE_DIR to use others than the system's.
find_path(NanoVDB_INCLUDE_DIR nanovdb/NanoVDB.h DOC "Folder that holds nanovdb/NanoVDB.h, 32.4 or later")
if(NOT NanoVDB_INCLUDE_DIR)
  message(FATAL_ERROR "NanoVDB was not found; install libnanovdb-dev or set NanoVDB_INCLUDE_DIR")
endif()
add_library(NanoVDB::headers INTERFACE IMPORTED)
target_include_directories(NanoVDB::headers SYSTEM INTERFACE ${NanoVDB_INCLUDE_DIR})
