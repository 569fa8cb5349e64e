# lostbits_join_sources(TARGET ROOMS): joins the sources of TARGET in folders whose path matches ROOMS, in the order of
# their paths, into units of about 600 kB. Code that they share, mostly templates of the standard library, is then
# compiled once per unit. Without this, a clean build of the program took 650 s of processor time. A folder is a
# namespace, so local names in two of its files must differ. The preset `dev` compiles each source by itself, and finds
# sources that rely on the includes of another.
function(lostbits_join_sources target rooms)
    if(NOT LOSTBITS_JOIN_SOURCES)
        return()
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # GCC takes the sources in a joined file for headers, in which a name that is local to a file would be a mistake.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    get_target_property(sources ${target} SOURCES)
    set(joined)
    set(all 0)
    foreach(source IN LISTS sources)
        get_filename_component(room "${source}" DIRECTORY)
        if(room MATCHES "${rooms}" AND source MATCHES "\\.cpp$" AND NOT source MATCHES "^${CMAKE_BINARY_DIR}/")
            get_filename_component(path "${source}" ABSOLUTE)
            file(SIZE "${path}" bytes_${source})
            math(EXPR all "${all} + ${bytes_${source}}")
            list(APPEND joined "${source}")
        endif()
    endforeach()
    math(EXPR units "(${all} + ${LOSTBITS_JOIN_BYTES} - 1) / ${LOSTBITS_JOIN_BYTES}")
    set(before 0)
    foreach(source IN LISTS joined)
        math(EXPR unit "${before} * ${units} / ${all}")
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${unit})
        math(EXPR before "${before} + ${bytes_${source}}")
    endforeach()
endfunction()
