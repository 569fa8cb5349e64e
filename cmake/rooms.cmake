# lostbits_whole_rooms(TARGET ROOMS): the sources of a folder whose path matches become one unit to the compiler. What they
# share, the library's templates above all, is compiled once for all of them: a clean build of the program took 650 s of
# processor without this. A room is a namespace, so two names of two of its files must differ even where they are local.
# The preset `dev` compiles each source by itself, and finds what one takes from another's includes.
function(lostbits_whole_rooms target rooms)
    if(NOT LOSTBITS_WHOLE_ROOMS)
        return()
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # GCC takes what the joint file includes for headers, in which a name that is local to a file would be a mistake.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    get_target_property(sources ${target} SOURCES)
    foreach(source IN LISTS sources)
        get_filename_component(room "${source}" DIRECTORY)
        if(room MATCHES "${rooms}" AND source MATCHES "\\.cpp$")
            string(MAKE_C_IDENTIFIER "room_${room}" group)
            set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
        endif()
    endforeach()
endfunction()
