# The wheel of the Python package, built and installed as a stranger would, and used from elsewhere: it maps a scene with
# the library, the libraries and the scenes that are in it.
#   PYTHON     the system's python3, with numpy, build and wheel
#   BUILD_DIR  where liblostbits.so is
#   SOURCE_DIR the repository
#   WORK_DIR   removed and made anew
include(${CMAKE_CURRENT_LIST_DIR}/step.cmake)
file(REMOVE_RECURSE ${WORK_DIR})
file(COPY ${SOURCE_DIR}/python DESTINATION ${WORK_DIR}/tree PATTERN build EXCLUDE PATTERN "*.egg-info" EXCLUDE)
file(COPY ${SOURCE_DIR}/data ${SOURCE_DIR}/CMakeLists.txt DESTINATION ${WORK_DIR}/tree)
set(ENV{LOSTBITS_BUILD} ${BUILD_DIR})
step(${PYTHON} -m build --wheel --no-isolation ${WORK_DIR}/tree/python -o ${WORK_DIR}/wheel)
file(GLOB wheels ${WORK_DIR}/wheel/*.whl)
if(NOT wheels MATCHES "/lostbits-[0-9.]+-py3-none-linux_[a-z0-9_]+\\.whl$")
    message(FATAL_ERROR "not one wheel for every Python 3: ${wheels}")
endif()
step(${PYTHON} -m venv --system-site-packages ${WORK_DIR}/venv)
step(${WORK_DIR}/venv/bin/pip install --no-index --no-deps ${wheels})
file(REMOVE_RECURSE ${WORK_DIR}/tree)
file(WRITE ${WORK_DIR}/use.py "
import lostbits as lb
m = lb.map('rtg-fig-7-3-4100-oblique', ['sphere.unified', 'sphere.schoolbook'], 'f32', progress=False)
assert dict(zip(m.summary['form'], m.summary['false_hit']))['sphere.unified'] < 100
maps = open('/proc/self/maps').read()
for name in ('liblostbits.so', 'libmpfr.so', 'libmpfi.so', 'libtbb.so'):
    paths = {line.split()[-1] for line in maps.splitlines() if '/' + name in line}
    assert len(paths) == 1 and paths.pop().startswith('${WORK_DIR}/venv/'), name
print('used')
")
unset(ENV{LOSTBITS_BUILD})
execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=PYTHONPATH --unset=LOSTBITS_LIBRARY --unset=LOSTBITS_DATA
    ${WORK_DIR}/venv/bin/python use.py WORKING_DIRECTORY ${WORK_DIR} RESULT_VARIABLE result OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
if(NOT result EQUAL 0 OR NOT output MATCHES "used")
    message(FATAL_ERROR "the installed package does not map a scene:\n${output}")
endif()
