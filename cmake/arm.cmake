# Cross compilation with Debian's compilers, against the libraries that scripts/sysroot unpacks; programs run under qemu.
# OPENCLOSE_ARM is Debian's name of the processor: arm64, armhf.

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES OPENCLOSE_ARM)
if(OPENCLOSE_ARM STREQUAL "arm64")
  set(CMAKE_SYSTEM_PROCESSOR aarch64)
  set(openclose_machine aarch64-linux-gnu)
  set(openclose_emulator qemu-aarch64)
elseif(OPENCLOSE_ARM STREQUAL "armhf")
  set(CMAKE_SYSTEM_PROCESSOR arm)
  set(openclose_machine arm-linux-gnueabihf)
  set(openclose_emulator qemu-arm)
else()
  message(FATAL_ERROR "OPENCLOSE_ARM is arm64 or armhf, not '${OPENCLOSE_ARM}'")
endif()

get_filename_component(CMAKE_SYSROOT ${CMAKE_CURRENT_LIST_DIR}/../build/sysroot-${OPENCLOSE_ARM} ABSOLUTE)
set(CMAKE_CXX_COMPILER ${openclose_machine}-g++)
set(CMAKE_LIBRARY_ARCHITECTURE ${openclose_machine})
# A false alarm of g++ 12 in what Eigen inlines.
set(CMAKE_CXX_FLAGS_INIT -Wno-free-nonheap-object)
set(CMAKE_CROSSCOMPILING_EMULATOR ${openclose_emulator} -L ${CMAKE_SYSROOT})

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
