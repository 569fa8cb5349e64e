# cmake -P embed.cmake: writes a C++ file with the texts of inline elements of the page, and with their hashes, which
# the page's content security policy names.
#   OUT     the file to write
#   ASSETS  name=part+part…,… : the text of a name is that of its parts in order; without parts it is empty
string(CONCAT code
    "// Made by cmake/embed.cmake from src/output/report/script; do not edit.\n"
    "#include \"output/report/assets.hpp\"\n\nnamespace lostbits::output::report {\n\n")
string(REPLACE "," ";" ASSETS "${ASSETS}")
foreach(asset IN LISTS ASSETS)
    string(REGEX MATCH "^([a-z_]+)=(.*)$" _ "${asset}")
    set(name "${CMAKE_MATCH_1}")
    string(REPLACE "+" ";" parts "${CMAKE_MATCH_2}")
    set(joined "${OUT}.${name}")
    file(WRITE "${joined}" "")
    foreach(part IN LISTS parts)
        file(READ "${part}" text)
        file(APPEND "${joined}" "${text}")
    endforeach()
    file(READ "${joined}" text)
    string(FIND "${text}" "</s" closing)
    if(NOT closing EQUAL -1)
        message(FATAL_ERROR "${name}: the text contains \"</s\", which would close its own element; split that string")
    endif()
    file(SHA256 "${joined}" hash)
    file(REMOVE "${joined}")
    string(APPEND code "const Asset ${name}{R\"asset(${text})asset\", \"${hash}\"};\n\n")
endforeach()
string(APPEND code "}  // namespace lostbits::output::report\n")
file(WRITE "${OUT}" "${code}")
