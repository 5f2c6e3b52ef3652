# What `cmake --install` leaves behind: the rooms as static libraries, the shared library of the C interface, public
# headers, the CMake package (find_package(pellucid), targets pellucid::<room>, pellucid::pellucid, pellucid::c),
# pellucid.pc, pellucid-c.pc and the licence.
# The command line installs itself (apps/pellucid).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(pellucid_rooms GLOBAL PROPERTY PELLUCID_ROOMS)

# All rooms at once.
add_library(pellucid_all INTERFACE)
add_library(pellucid::pellucid ALIAS pellucid_all)
set_target_properties(pellucid_all PROPERTIES EXPORT_NAME pellucid)
target_link_libraries(pellucid_all INTERFACE ${pellucid_rooms})

install(TARGETS ${pellucid_rooms} pellucid_all EXPORT pellucidTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
# Apart from the others: programs that use it need none of the libraries inside.
install(TARGETS pellucid_c EXPORT pellucidCTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/pellucid DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The CMake package. Static libraries hand their private dependencies on to whoever links them, so the
# package finds every one of them.
set(pellucid_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pellucid)
install(EXPORT pellucidTargets NAMESPACE pellucid:: DESTINATION ${pellucid_package_dir})
install(EXPORT pellucidCTargets NAMESPACE pellucid:: DESTINATION ${pellucid_package_dir})
configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/pellucidConfig.cmake.in ${PROJECT_BINARY_DIR}/pellucidConfig.cmake
  INSTALL_DESTINATION ${pellucid_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pellucidConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pellucidConfig.cmake ${PROJECT_BINARY_DIR}/pellucidConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindOpenSubdivCpu.cmake DESTINATION ${pellucid_package_dir})

# pkg-config: users before what they use, as the linker wants static libraries. Relocatable: the prefix is found
# from where the file lies.
file(RELATIVE_PATH pellucid_pc_up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
set(pellucid_pc_libraries "")
foreach(room IN LISTS pellucid_rooms)
  string(PREPEND pellucid_pc_libraries "-l${room} ")
endforeach()
set(pellucid_pc_vulkan "")
if(PELLUCID_RENDER)
  set(pellucid_pc_vulkan " -lvulkan")
endif()
configure_file(${PROJECT_SOURCE_DIR}/cmake/pellucid.pc.in ${PROJECT_BINARY_DIR}/pellucid.pc @ONLY)
configure_file(${PROJECT_SOURCE_DIR}/cmake/pellucid-c.pc.in ${PROJECT_BINARY_DIR}/pellucid-c.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/pellucid.pc ${PROJECT_BINARY_DIR}/pellucid-c.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
