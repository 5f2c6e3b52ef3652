# What `cmake --install` leaves behind: the modules as static libraries, the shared library of the C interface, public
# headers, the CMake package (find_package(pellucid), targets pellucid::<module>, pellucid::pellucid, pellucid::c),
# pellucid.pc, pellucid-c.pc and the licence.
# The command line installs itself (apps/pellucid).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(pellucid_modules GLOBAL PROPERTY PELLUCID_MODULES)

install(TARGETS ${pellucid_modules} pellucid_all EXPORT pellucidTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
# Apart from the others: programs that use it need none of the libraries inside.
install(TARGETS pellucid_c EXPORT pellucidCTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
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
foreach(module IN LISTS pellucid_modules)
  string(PREPEND pellucid_pc_libraries "-l${module} ")
endforeach()
string(APPEND pellucid_pc_libraries "-lmeshoptimizer -lembree${embree_VERSION_MAJOR}")
set(pellucid_pc_requires "libhwy fmt libpng")
foreach(feature "TBB|tbb|" "JPEG|libjpeg|" "OPENEXR|OpenEXR|" "OPENSUBDIV||-losdCPU" "VULKAN||-lvulkan")
  string(REPLACE "|" ";" feature "${feature}")
  list(GET feature 0 option)
  if(PELLUCID_${option})
    list(GET feature 1 package)
    list(GET feature 2 library)
    string(APPEND pellucid_pc_requires " ${package}")
    string(APPEND pellucid_pc_libraries " ${library}")
  endif()
endforeach()
configure_file(${PROJECT_SOURCE_DIR}/cmake/pellucid.pc.in ${PROJECT_BINARY_DIR}/pellucid.pc @ONLY)
configure_file(${PROJECT_SOURCE_DIR}/cmake/pellucid-c.pc.in ${PROJECT_BINARY_DIR}/pellucid-c.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/pellucid.pc ${PROJECT_BINARY_DIR}/pellucid-c.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
