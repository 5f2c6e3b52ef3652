# Toolchain of preset `windows`: programs for Windows by MinGW-w64 on Linux (Debian's g++-mingw-w64-x86-64-posix), whose
# tests run under Wine. scripts/windows prepares what it needs.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_CROSSCOMPILING_EMULATOR /usr/lib/wine/wine64)
# Programs run without the compiler's own DLLs beside them.
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)

# Libraries of the host must not be found: only those that scripts/windows has put here.
set(PELLUCID_WINDOWS_ROOT ${CMAKE_CURRENT_LIST_DIR}/../../build/windows-root)
set(CMAKE_FIND_ROOT_PATH /usr/x86_64-w64-mingw32 ${PELLUCID_WINDOWS_ROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# Findhwy, Findmeshoptimizer and Findembree: headers alone.
list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})
