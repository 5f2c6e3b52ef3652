# For scripts/sanitize --short: modules that are linked but not tested there, built without sanitizers and optimisation.
# Where PELLUCID_PLAIN_ARCHIVES names a folder, their libraries are taken from there and not built at all.
set(PELLUCID_PLAIN_MODULES "" CACHE STRING "Modules built without sanitizers and optimisation")
set(PELLUCID_PLAIN_ARCHIVES "" CACHE PATH "Libraries of another build that stand for the plain modules")
mark_as_advanced(PELLUCID_PLAIN_MODULES PELLUCID_PLAIN_ARCHIVES)

# pellucid_module(<name> SOURCES ... USES <modules or targets> PRIVATE_USES ...)
# Adds one static library `pellucid_<name>`, alias `pellucid::<name>`, for the module src/<name>.
function(pellucid_module name)
  cmake_parse_arguments(MODULE "" "" "SOURCES;USES;PRIVATE_USES" ${ARGN})
  if(PELLUCID_PLAIN_ARCHIVES AND name IN_LIST PELLUCID_PLAIN_MODULES)
    add_library(pellucid_${name} STATIC IMPORTED GLOBAL)
    set_target_properties(pellucid_${name} PROPERTIES
      IMPORTED_LOCATION ${PELLUCID_PLAIN_ARCHIVES}/libpellucid_${name}.a)
    add_library(pellucid::${name} ALIAS pellucid_${name})
    target_include_directories(pellucid_${name} INTERFACE ${PROJECT_SOURCE_DIR}/include)
    target_link_libraries(pellucid_${name} INTERFACE ${MODULE_USES} ${MODULE_PRIVATE_USES})
    return()
  endif()
  add_library(pellucid_${name} STATIC ${MODULE_SOURCES})
  add_library(pellucid::${name} ALIAS pellucid_${name})
  set_target_properties(pellucid_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(pellucid_${name} PUBLIC cxx_std_20)
  target_include_directories(pellucid_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(pellucid_${name}
    PUBLIC ${MODULE_USES}
    PRIVATE $<BUILD_INTERFACE:pellucid_defaults> ${MODULE_PRIVATE_USES})
  if(name IN_LIST PELLUCID_PLAIN_MODULES)
    target_compile_options(pellucid_${name} PRIVATE -O0 -fno-sanitize=all)
  endif()
  set_property(GLOBAL APPEND PROPERTY PELLUCID_MODULES pellucid_${name})
endfunction()
