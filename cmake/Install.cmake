# What `cmake --install` puts where: the program, the shared library with its one public header, the scenes, and the
# package files for find_package(hemiray). The shared library hides its own dependencies, so users need none of them.
include(CMakePackageConfigHelpers)

add_library(hemiray_shared SHARED $<TARGET_OBJECTS:hemiray_core>)
add_library(hemiray::hemiray ALIAS hemiray_shared)
set(HR_EXPORTS ${CMAKE_SOURCE_DIR}/cmake/exports.map)
target_link_libraries(hemiray_shared PRIVATE ${HR_DEPENDENCIES})
target_link_options(hemiray_shared PRIVATE -Wl,--version-script=${HR_EXPORTS} -Wl,--no-undefined)
target_compile_features(hemiray_shared INTERFACE cxx_std_20)
target_include_directories(hemiray_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# Before 1.0 every minor version may change the binary interface.
set_target_properties(hemiray_shared PROPERTIES OUTPUT_NAME hemiray EXPORT_NAME hemiray LINKER_LANGUAGE CXX
                      LINK_DEPENDS ${HR_EXPORTS} VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
if(HR_SANITIZE)  # sanitizer runtimes live in the program, so the library has undefined symbols
  set_property(TARGET hemiray_shared PROPERTY LINK_OPTIONS -Wl,--version-script=${HR_EXPORTS})
endif()

install(TARGETS hemiray_shared EXPORT hemiray_targets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS hemiray_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES host/api/hemiray.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hemiray)
install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/hemiray/scenes)
install(FILES bench/bars.json bench/plot.py DESTINATION ${CMAKE_INSTALL_DATADIR}/hemiray/bench)

set(HR_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/hemiray)
install(EXPORT hemiray_targets FILE hemirayTargets.cmake NAMESPACE hemiray:: DESTINATION ${HR_PACKAGE_DIR})
configure_package_config_file(cmake/hemirayConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/hemirayConfig.cmake
                              INSTALL_DESTINATION ${HR_PACKAGE_DIR} PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/hemirayConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/hemirayConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/hemirayConfigVersion.cmake
        DESTINATION ${HR_PACKAGE_DIR})
