# Installs headers and what find_package(Alidade) needs. Libraries and the
# program are installed where they are defined, under src.

include(CMakePackageConfigHelpers)

set(ALIDADE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Alidade)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/alidade
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h")

# Arm files to start from (docs/robots.md).
install(DIRECTORY ${PROJECT_SOURCE_DIR}/configs/robots
  DESTINATION ${CMAKE_INSTALL_DATADIR}/alidade
  FILES_MATCHING PATTERN "*.yaml")

# For editors: a file's first line may name its schema (docs/files.md).
install(DIRECTORY ${PROJECT_SOURCE_DIR}/schemas
  DESTINATION ${CMAKE_INSTALL_DATADIR}/alidade
  FILES_MATCHING PATTERN "*.json")

# What those pages' commands name, where their links find it.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/configs ${PROJECT_SOURCE_DIR}/datasets
  DESTINATION ${CMAKE_INSTALL_DOCDIR}
  FILES_MATCHING PATTERN "*.yaml" PATTERN "*.csv" PATTERN "*.txt"
  PATTERN "*.src")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/python/examples
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/python
  FILES_MATCHING PATTERN "*.ipynb" PATTERN "*.py"
  PATTERN ".ipynb_checkpoints" EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR})

# Headers refer to these pages.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs
  DESTINATION ${CMAKE_INSTALL_DOCDIR}
  FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png")

install(EXPORT AlidadeTargets
  NAMESPACE Alidade::
  DESTINATION ${ALIDADE_PACKAGE_DIR})

configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/AlidadeConfig.cmake.in
  ${PROJECT_BINARY_DIR}/AlidadeConfig.cmake
  INSTALL_DESTINATION ${ALIDADE_PACKAGE_DIR})

write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/AlidadeConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)

install(FILES
  ${PROJECT_BINARY_DIR}/AlidadeConfig.cmake
  ${PROJECT_BINARY_DIR}/AlidadeConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/YamlCppTarget.cmake
  DESTINATION ${ALIDADE_PACKAGE_DIR})
