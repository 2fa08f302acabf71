# Installs the built library to a fresh prefix, then configures, builds and
# runs the project in this directory against it. Stops at the first failure.
#
# Variables: ALIDADE_BINARY_DIR CONSUMER_SOURCE_DIR WORK_DIR GENERATOR
# CXX_COMPILER BUILD_TYPE SANITIZE

set(prefix ${WORK_DIR}/prefix)
set(build ${WORK_DIR}/build)
file(REMOVE_RECURSE ${WORK_DIR})

# A sanitized library wants a sanitized program.
set(flags "")
if(SANITIZE)
  set(flags -fsanitize=${SANITIZE})
endif()

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${ALIDADE_BINARY_DIR} --prefix ${prefix})
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${CONSUMER_SOURCE_DIR} -B ${build}
  -D CMAKE_PREFIX_PATH=${prefix}
  -D CMAKE_CXX_COMPILER=${CXX_COMPILER}
  -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
  -D CMAKE_CXX_FLAGS=${flags})
run(${CMAKE_COMMAND} --build ${build})
run(${build}/consumer)
