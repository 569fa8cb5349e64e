include(${CMAKE_CURRENT_LIST_DIR}/step.cmake)

file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR}/elsewhere)
# That of the plugins takes as long, and is made in the long tests.
set(parts -D CPACK_COMPONENTS_ALL=Unspecified)
if(DEFINED ENV{LOSTBITS_LONG})
    set(parts)
endif()
step(${CMAKE_COMMAND} -E chdir ${BUILD_DIR} cpack -G DEB ${parts} -B ${WORK_DIR}/made)
file(GLOB package ${WORK_DIR}/made/lostbits_*.deb)
list(LENGTH package count)
if(NOT count EQUAL 1)
    message(FATAL_ERROR "cpack made ${count} packages: ${package}")
endif()

# It asks for the libraries that it is linked with, and for its letters.
step(dpkg-deb --field ${package} Depends)
foreach(library libmpfr6 libmpfi0 libopenimageio libcairo2 libtbb fonts-dejavu-core)
    if(NOT last_output MATCHES "${library}")
        message(FATAL_ERROR "the package does not depend on ${library}: ${last_output}")
    endif()
endforeach()

# Into a root of its own: this machine is not changed, what the package depends on is the machine's, and no script of
# the package (ldconfig) runs.
set(root ${WORK_DIR}/root)
file(MAKE_DIRECTORY ${root}/var/lib/dpkg/info ${root}/var/lib/dpkg/updates)
file(TOUCH ${root}/var/lib/dpkg/status)
step(dpkg --root=${root} --log=${WORK_DIR}/dpkg.log --force-depends --force-not-root --force-bad-path
    --unpack ${package})
set(program ${root}/usr/bin/lostbits)

function(run)
    step(${CMAKE_COMMAND} -E chdir ${WORK_DIR}/elsewhere ${CMAKE_COMMAND} -E env --unset=LOSTBITS_DATA ${program}
        ${ARGN})
    set(last_output "${last_output}" PARENT_SCOPE)
endfunction()
run(--version)
if(NOT last_output MATCHES "lostbits ${VERSION}")
    message(FATAL_ERROR "the installed program is ${last_output}")
endif()
# A built-in name works: the data are found, and the image module.
run(map near-benign -i sphere.press -f f32 --size 16x16 --exr -o out)
foreach(file summary.csv contact.png near-benign.exr manifest.json)
    if(NOT EXISTS ${WORK_DIR}/elsewhere/out/near-benign/${file})
        message(FATAL_ERROR "the installed program did not write ${file}")
    endif()
endforeach()
foreach(file share/bash-completion/completions/lostbits share/zsh/vendor-completions/_lostbits
        share/fish/vendor_completions.d/lostbits.fish share/man/man1/lostbits.1)
    file(GLOB installed ${root}/usr/${file}*)
    if(NOT installed)
        message(FATAL_ERROR "the package has no ${file}")
    endif()
endforeach()
