# Installs the built library to a fresh prefix, then configures, builds and
# runs the project in this directory against it, and one that is made of the
# blocks of README.md. Stops at the first failure.
#
# Variables: ALIDADE_BINARY_DIR CONSUMER_SOURCE_DIR PROJECT_DIR WORK_DIR
# GENERATOR CXX_COMPILER BUILD_TYPE SANITIZE

set(prefix ${WORK_DIR}/prefix)
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

# Builds the project in `source` and runs its program, in the build folder.
function(build_and_run source build program)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${source} -B ${build}
    -D CMAKE_PREFIX_PATH=${prefix}
    -D CMAKE_CXX_COMPILER=${CXX_COMPILER}
    -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
    -D CMAKE_CXX_FLAGS=${flags})
  run(${CMAKE_COMMAND} --build ${build})
  execute_process(COMMAND ${build}/${program} WORKING_DIRECTORY ${build}
    COMMAND_ERROR_IS_FATAL ANY)
endfunction()

build_and_run(${CONSUMER_SOURCE_DIR} ${WORK_DIR}/build consumer)

# The first block of a language in README.md.
file(READ ${PROJECT_DIR}/README.md readme)
function(readme_block language output)
  string(FIND "${readme}" "```${language}\n" first)
  string(SUBSTRING "${readme}" ${first} -1 block)
  string(REPLACE "```${language}\n" "" block "${block}")
  string(FIND "${block}" "```" last)
  string(SUBSTRING "${block}" 0 ${last} block)
  set(${output} "${block}" PARENT_SCOPE)
endfunction()

set(source ${WORK_DIR}/readme)
readme_block(cpp program)
file(WRITE ${source}/main.cc "${program}")
readme_block(cmake linked)
file(WRITE ${source}/CMakeLists.txt
  "cmake_minimum_required(VERSION 3.25)\nproject(Mine LANGUAGES CXX)\n"
  "add_executable(mine main.cc)\n${linked}")
# Its files are those of the study.
file(MAKE_DIRECTORY ${WORK_DIR}/readme_build)
file(COPY_FILE ${PROJECT_DIR}/configs/robots/rv2aj_flange.yaml
  ${WORK_DIR}/readme_build/arm.yaml)
file(COPY_FILE ${PROJECT_DIR}/datasets/rv2aj/flange_56.csv
  ${WORK_DIR}/readme_build/measured.csv)
build_and_run(${source} ${WORK_DIR}/readme_build mine)
if(NOT EXISTS ${WORK_DIR}/readme_build/results/my_arm/arm.yaml)
  message(FATAL_ERROR "README's program has written no result")
endif()
