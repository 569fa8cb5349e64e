"""Makes the wheel: the package, liblostbits.so, the libraries that it needs, and the scenes and sweeps.

    ninja -C build lostbits_library && python3 -m build --wheel --no-isolation python -o build/wheel

$LOSTBITS_BUILD names another build folder. The wheel's library is stripped; symbols stay in the build folder.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

ROOT = Path(__file__).resolve().parent.parent
BUILD = Path(os.environ.get("LOSTBITS_BUILD", ROOT / "build"))
# Parts of the C library, which every Linux has. All other libraries are copied into the wheel.
SYSTEM = ("libc.so", "libm.so", "libpthread.so", "libdl.so", "librt.so", "ld-linux", "linux-vdso", "libresolv.so")


def needed(library):
    """Files of the shared libraries that the loader finds for a library, without those of SYSTEM."""
    listed = subprocess.run(["ldd", library], check=True, capture_output=True, text=True).stdout
    return [Path(path) for name, path in re.findall(r"(\S+) => (\S+)", listed) if not name.startswith(SYSTEM)]


class WithLibrary(build_py):
    def run(self):
        super().run()
        package = Path(self.build_lib) / "lostbits"
        library = BUILD / "liblostbits.so"
        if not library.is_file():
            raise SystemExit(f"{library} does not exist; build it first: ninja -C {BUILD} lostbits_library")
        (package / "lib").mkdir(parents=True, exist_ok=True)
        for each in (library, *needed(library)):
            copy = package / "lib" / each.name
            shutil.copyfile(each.resolve(), copy)
            subprocess.run(["strip", "--strip-unneeded", copy], check=True)
        for folder in ("scenes", "sweeps"):
            shutil.copytree(ROOT / "data" / folder, package / "data" / folder, dirs_exist_ok=True)


class ForThisProcessor(bdist_wheel):
    """A wheel for any Python 3 on this kind of processor, since nothing in it is compiled against Python."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


version = re.search(r"project\(lostbits VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
setup(version=version, cmdclass={"build_py": WithLibrary, "bdist_wheel": ForThisProcessor})
