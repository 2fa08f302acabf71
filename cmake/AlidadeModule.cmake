# alidade_compile_options(<target>)
#
# Language level, warnings and sanitizers of our own targets. Warnings stay
# private. The sanitizers' link flags are passed on, since a program that links
# a sanitized library needs them too.
function(alidade_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
  # A constant of a function would be reported where a source that is compiled
  # together with its own has one of the same name.
  target_compile_options(${target} PRIVATE
    $<$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>:-Wno-shadow>)
  if(ALIDADE_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(ALIDADE_SANITIZE)
    target_compile_options(${target} PRIVATE
      -fsanitize=${ALIDADE_SANITIZE} -fno-sanitize-recover=all
      -fno-omit-frame-pointer
      # GCC 12 sees uninitialized members in std::regex when it sanitizes.
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    # GCC looks for memory to free after every few megabytes, a tenth of its time
    # beside precompiled headers, unless it may take more.
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
      target_compile_options(${target} PRIVATE
        --param=ggc-min-heapsize=1000000)
    endif()
    # What the address sanitizer finds as well, at a third of the compiler's
    # time: pointers that are wrong harm where they are used.
    if(ALIDADE_SANITIZE MATCHES address AND ALIDADE_SANITIZE MATCHES undefined)
      target_compile_options(${target} PRIVATE
        -fno-sanitize=null,alignment,object-size,pointer-overflow)
    endif()
    # Marking the scope of each local variable takes another third, and three
    # quarters in the vector kernels, for Eigen's temporaries and inlined
    # arguments. -Wdangling-pointer, and clang-tidy with its dangling handles and
    # inner pointers, look for uses after the scope instead.
    if(ALIDADE_SANITIZE MATCHES address)
      target_compile_options(${target} PRIVATE
        -fno-sanitize-address-use-after-scope)
      # Eigen would allocate in another way than the distribution's Ceres, with
      # which matrices and weak symbols are shared; programs that link a sanitized
      # library share them, too.
      target_compile_definitions(${target} PUBLIC
        EIGEN_MALLOC_ALREADY_ALIGNED=1)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${ALIDADE_SANITIZE})
  endif()
endfunction()

set(ALIDADE_TEXT_MODULES dataio serialization report job fleet)

# alidade_module(<module> <source>...)
#
# Adds the static library alidade_<module> from sources in the current
# directory, and installs it. Users and other modules call it
# Alidade::<module>.
#
# Public headers are included as "alidade/<module>/x.h", headers that stay
# inside a module as "src/<module>/x.h".
function(alidade_module module)
  set(target alidade_${module})
  add_library(${target} STATIC ${ARGN})
  add_library(Alidade::${module} ALIAS ${target})
  # Shared objects, the Python package's first, are linked of these libraries.
  # Hidden symbols are called directly, as in a program.
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${module}
    POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  alidade_compile_options(${target})
  # Tests spend their time in the numerical modules, which are optimised; those
  # of text take the compiler a quarter less without.
  if(ALIDADE_BUILD_FUZZERS)
    # As the preset says.
  elseif(ALIDADE_SANITIZE AND module IN_LIST ALIDADE_TEXT_MODULES)
    target_compile_options(${target} PRIVATE -Og)
  elseif(ALIDADE_SANITIZE)
    target_compile_options(${target} PRIVATE -O2)
  endif()
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${target} PRIVATE fmt::fmt glog::glog)
  install(TARGETS ${target} EXPORT AlidadeTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()
