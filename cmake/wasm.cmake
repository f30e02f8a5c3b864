# WebAssembly for node, by Debian's emscripten. The command reads and writes files of this machine; it has one thread and no child processes.

find_program(openclose_emscripten em++ REQUIRED)
file(REAL_PATH ${openclose_emscripten} openclose_emscripten)
cmake_path(GET openclose_emscripten PARENT_PATH openclose_emscripten)
foreach(folder ${openclose_emscripten} /usr/share/emscripten)
  if(EXISTS ${folder}/cmake/Modules/Platform/Emscripten.cmake)
    set(EMSCRIPTEN_ROOT_PATH ${folder})
  endif()
endforeach()
include(${EMSCRIPTEN_ROOT_PATH}/cmake/Modules/Platform/Emscripten.cmake)

set(CMAKE_CXX_FLAGS_INIT "-fwasm-exceptions -include ${CMAKE_CURRENT_LIST_DIR}/wasm_library.h")
set(CMAKE_EXE_LINKER_FLAGS_INIT
  "-fwasm-exceptions -sENVIRONMENT=node -sNODERAWFS=1 -sALLOW_MEMORY_GROWTH=1 -sEXIT_RUNTIME=1 --pre-js ${CMAKE_CURRENT_LIST_DIR}/wasm_start.js")
