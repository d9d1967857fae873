# Toolchain of a probe's package: Debian's cross compiler with the libraries that tools/setup/arm64-sysroot unpacked.
# cmake -DCMAKE_TOOLCHAIN_FILE=cmake/arm64.cmake -DENAMEL_SYSROOT=$(tools/setup/arm64-sysroot) -DENAMEL_PROBE_ONLY=ON
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ENAMEL_SYSROOT)

set(CMAKE_SYSROOT ${ENAMEL_SYSROOT})
set(CMAKE_FIND_ROOT_PATH ${ENAMEL_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(kind LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${ENAMEL_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${ENAMEL_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${ENAMEL_SYSROOT}/usr/share/pkgconfig)
