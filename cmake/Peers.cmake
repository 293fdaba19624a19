# The tracers that the benchmark measures beside ours, as a library of their own (bench/peers): only where they are
# installed, so that hemiray builds without them.
if(HR_PEERS AND NOT (HR_PEERS STREQUAL "AUTO" AND HR_SANITIZE))  # sanitizers report what Embree and TBB keep
  find_path(HR_EMBREE_INCLUDE_DIR embree3/rtcore.h)
  find_library(HR_EMBREE_LIBRARY embree3)
  if(HR_EMBREE_INCLUDE_DIR AND HR_EMBREE_LIBRARY)
    file(GLOB HR_PEER_SOURCES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/bench/peers/*.cpp)
    add_library(hemiray_peers STATIC ${HR_PEER_SOURCES})
    hr_warnings(hemiray_peers)
    target_compile_definitions(hemiray_peers PUBLIC HR_HAS_EMBREE)
    target_include_directories(hemiray_peers SYSTEM PRIVATE ${HR_EMBREE_INCLUDE_DIR})
    target_link_libraries(hemiray_peers PUBLIC hemiray_core PRIVATE ${HR_EMBREE_LIBRARY})
  elseif(NOT HR_PEERS STREQUAL "AUTO")
    message(FATAL_ERROR "HR_PEERS is ${HR_PEERS}, but Embree 3 is not installed (Debian: libembree-dev)")
  endif()
endif()
