# yaml-cpp 0.8 (Ubuntu 24.04) names its target yaml-cpp::yaml-cpp, 0.7
# (Debian 12) yaml-cpp. We use the new name with both.

if(NOT TARGET yaml-cpp::yaml-cpp)
  add_library(yaml-cpp::yaml-cpp INTERFACE IMPORTED)
  target_link_libraries(yaml-cpp::yaml-cpp INTERFACE yaml-cpp)
endif()
