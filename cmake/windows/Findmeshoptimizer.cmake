# meshoptimizer's header alone: sources that call it compile, programs that need them do not link.
add_library(meshoptimizer::meshoptimizer INTERFACE IMPORTED)
target_include_directories(meshoptimizer::meshoptimizer INTERFACE ${PELLUCID_WINDOWS_ROOT}/include)
set(meshoptimizer_FOUND TRUE)
