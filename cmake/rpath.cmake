# Executables of the build tree also look for libraries in lib/ beside them or beside their folder: scripts/bundle.sh
# copies them as they are. RPATH, not RUNPATH, because the libraries' own libraries lie there too. Installed ones have none.
if(PROJECT_IS_TOP_LEVEL AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
  list(APPEND CMAKE_BUILD_RPATH "$ORIGIN/lib" "$ORIGIN/../lib")
  add_link_options("LINKER:--disable-new-dtags")
endif()
