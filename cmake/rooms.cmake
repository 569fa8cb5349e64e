# lostbits_join_sources(TARGET ROOMS): the sources in folders whose path matches are handed to the compiler some 600 kB
# at a time, in the order of their paths. What they share, the library's templates above all, is compiled once for
# all of them: a clean build of the program took 650 s of processor without this. A room is a namespace, so two names of
# two of its files must differ even where they are local. The preset `dev` compiles each source by itself, and finds what
# one takes from another's includes.
function(lostbits_join_sources target rooms)
    if(NOT LOSTBITS_JOIN_SOURCES)
        return()
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # GCC takes what the joint file includes for headers, in which a name that is local to a file would be a mistake.
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
