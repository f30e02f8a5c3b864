# Writes a C++ source that holds text files: cmake -DFILES=a.html;b.js -DOUTPUT=page_files.cpp -P embed_files.cmake
#
# The source defines embedded_style, embedded_scripts (all .js in their order) and embedded_page of src/report/page_files.h. Compilers limit the length
# of a string literal as it is written, so that a file becomes several, and of what they are joined to (65,536 bytes need to be accepted): the scripts
# stay apart.

set(longest_literal 12000)

function(literal_of text result)
  string(LENGTH "${text}" length)
  set(literals "")
  set(begin 0)
  while(begin LESS length)
    string(SUBSTRING "${text}" ${begin} ${longest_literal} piece)
    string(APPEND literals "R\"page~(${piece})page~\"\n")
    math(EXPR begin "${begin} + ${longest_literal}")
  endwhile()
  set(${result} "${literals}" PARENT_SCOPE)
endfunction()

set(scripts "")
foreach(path ${FILES})
  file(READ "${path}" text)
  if(path MATCHES "\\.js$")
    literal_of("${text}\n" script)
    string(APPEND scripts "${script},\n")
  elseif(path MATCHES "\\.css$")
    literal_of("${text}" style)
  else()
    literal_of("${text}" page)
  endif()
endforeach()

file(WRITE "${OUTPUT}" "#include \"openclose/report/page_files.h\"\n\nnamespace openclose {\n\n"
  "const char* const embedded_page =\n${page};\nconst char* const embedded_style =\n${style};\n"
  "static const char* const scripts[] = {\n${scripts}};\nconst std::span<const char* const> embedded_scripts = scripts;\n\n"
  "}  // namespace openclose\n")
