# Compiles through ccache where it is installed.
#
# The sloppiness is what ccache's manual asks for with precompiled headers,
# without which it would cache nothing that uses one. What it compares are the
# files that the compiler says it has read, for which no preprocessor runs first.

find_program(ALIDADE_CCACHE ccache)
mark_as_advanced(ALIDADE_CCACHE)

if(PROJECT_IS_TOP_LEVEL AND ALIDADE_CCACHE
   AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env
    CCACHE_DEPEND=1
    CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    ${ALIDADE_CCACHE})
endif()
