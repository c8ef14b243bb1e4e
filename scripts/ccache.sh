# Sourced by what builds with ccache: lets it take precompiled headers, and a library that was compiled in one folder of
# build for another one.
export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
