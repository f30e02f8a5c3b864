# What the command includes, for compilers whose libraries are not those of this machine: headers alone, found where Debian has them and linked into a
# folder without anything else, since the C library beside them is this machine's.
set(openclose_headers ${PROJECT_BINARY_DIR}/headers)

function(openclose_header_package target header)
  cmake_parse_arguments(ARG "" "" "PATHS;DEFINITIONS" ${ARGN})
  find_path(folder ${header} PATHS /usr/include /usr/local/include PATH_SUFFIXES ${ARG_PATHS} NO_CACHE NO_CMAKE_FIND_ROOT_PATH REQUIRED)
  cmake_path(GET header PARENT_PATH name)
  file(MAKE_DIRECTORY ${openclose_headers})
  file(CREATE_LINK ${folder}/${name} ${openclose_headers}/${name} SYMBOLIC)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} INTERFACE ${openclose_headers})
  target_compile_definitions(${target} INTERFACE ${ARG_DEFINITIONS})
endfunction()

openclose_header_package(Eigen3::Eigen Eigen/Core PATHS eigen3)
openclose_header_package(fmt::fmt fmt/format.h DEFINITIONS FMT_HEADER_ONLY=1)
openclose_header_package(tomlplusplus::tomlplusplus toml++/toml.h DEFINITIONS TOML_HEADER_ONLY=1)
openclose_header_package(CLI11::CLI11 CLI/CLI.hpp)
openclose_header_package(nlohmann_json::nlohmann_json nlohmann/json.hpp)

# Debian's emscripten optimises its JavaScript with a package that only Debian's node finds by itself.
set_property(GLOBAL PROPERTY RULE_LAUNCH_LINK "${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs")
