# Writes the parts of the page as C++ strings.
#
# cmake -D OUTPUT=FILE -D PAGE=DIR "-D SCRIPTS=a.js;b.js"
#   -P embed.cmake
#
# One string literal may be long, but not longer than some compilers take, so
# that every file is one of its own.

function(append_part name)
  set(pieces "")
  foreach(file IN LISTS ARGN)
    file(READ "${PAGE}/${file}" text)
    string(FIND "${text}" ")alidade_page\"" end)
    if(NOT end EQUAL -1)
      message(FATAL_ERROR "${file} holds the mark that ends a string")
    endif()
    string(APPEND pieces "  text += R\"alidade_page(${text})alidade_page\";\n")
  endforeach()
  string(APPEND source
    "std::string ${name}() {\n  std::string text;\n${pieces}  return text;\n}\n\n")
  set(source "${source}" PARENT_SCOPE)
endfunction()

set(source "// Made by embed.cmake of the files beside it.\n\n#include \"src/report/page_files.h\"\n\nnamespace alidade::internal {\n\n")
append_part(PageTemplate page.html)
append_part(PageStyle page.css)
append_part(FigureStyle figures.css)
append_part(PageScript ${SCRIPTS})
string(APPEND source "}  // namespace alidade::internal\n")
file(WRITE "${OUTPUT}" "${source}")
