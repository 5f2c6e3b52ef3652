# Embree's headers alone: sources that call it compile, programs that need them do not link.
add_library(embree INTERFACE IMPORTED)
target_include_directories(embree INTERFACE ${PELLUCID_WINDOWS_ROOT}/include)
set(embree_VERSION_MAJOR 3)
set(embree_FOUND TRUE)
