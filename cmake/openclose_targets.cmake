# How a folder becomes a target.
#
#   openclose_library(NAME SOURCES a.cpp ... DEPENDS other folders or imported targets ...)
#
# A header of src/<folder> is included as "openclose/<folder>/file.h". That path is a link in the build
# tree which only the targets linked to the folder can see, so an include against the direction of the
# data (the order of src/CMakeLists.txt) does not compile.

add_library(openclose_options INTERFACE)
target_compile_options(openclose_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -ffp-contract=off)  # the same bits on every machine
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm)")
  # Where this is defined, Eigen multiplies and adds in one operation, which rounds once; nobody asks the compiler.
  target_compile_options(openclose_options INTERFACE -U__ARM_FEATURE_FMA)
endif()
if(OPENCLOSE_TUNE)
  target_compile_options(openclose_options INTERFACE -march=native)
endif()
if(OPENCLOSE_SANITIZE)
  target_compile_options(openclose_options INTERFACE -fsanitize=${OPENCLOSE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(openclose_options INTERFACE -fsanitize=${OPENCLOSE_SANITIZE})
endif()
if(OPENCLOSE_TRAPS)
  # clang++ moves operations in front of the question whether they are needed, g++ does not.
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    message(FATAL_ERROR "OPENCLOSE_TRAPS needs g++")
  endif()
  target_sources(openclose_options INTERFACE $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${CMAKE_CURRENT_LIST_DIR}/traps/traps.cpp>)
  target_compile_definitions(openclose_options INTERFACE OPENCLOSE_TRAPS)
endif()
target_include_directories(openclose_options INTERFACE ${CMAKE_CURRENT_LIST_DIR}/traps)

if(OPENCLOSE_FUZZ)
  # fuzzer-no-link: what runs is watched; only the harnesses have the fuzzer's main program.
  target_compile_options(openclose_options INTERFACE -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(openclose_options INTERFACE -fsanitize=address,undefined)
endif()

function(openclose_include_root target folder)
  set(root ${PROJECT_BINARY_DIR}/include/${folder})
  file(MAKE_DIRECTORY ${root}/openclose)
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${root}/openclose/${folder} SYMBOLIC)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${root}> $<INSTALL_INTERFACE:include>)
endfunction()

# For programs that use the folders as libraries: find_package(openclose), openclose::analysis and the like. Tests and verification are not installed.
function(openclose_install_library name)
  if(NOT CMAKE_CURRENT_SOURCE_DIR MATCHES "^${PROJECT_SOURCE_DIR}/(src|analytical/limit_analysis)")
    return()
  endif()
  set_target_properties(openclose_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS openclose_${name} EXPORT openclose_targets ARCHIVE DESTINATION lib/openclose)
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION include/openclose/${name} FILES_MATCHING PATTERN "*.h")
endfunction()

function(openclose_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(openclose_${name} STATIC ${ARG_SOURCES})
  add_library(openclose::${name} ALIAS openclose_${name})
  openclose_include_root(openclose_${name} ${name})
  target_link_libraries(openclose_${name} PUBLIC ${ARG_DEPENDS} PRIVATE $<BUILD_INTERFACE:openclose_options>)
  openclose_install_library(${name})
endfunction()
