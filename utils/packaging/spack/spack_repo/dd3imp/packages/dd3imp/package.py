# SPDX-License-Identifier: GPL-3.0-or-later
"""Recipe of Spack for a clone or the source distribution, see utils/packaging/README.md."""

import os
from pathlib import Path

from spack.package import default_args, depends_on, license, requires, variant, version, when
from spack_repo.builtin.build_systems.cmake import CMakePackage, generator


class Dd3imp(CMakePackage):
    """Implicit finite element simulation of sheet metal forming with rigid tools.

    Its constitutive laws are a library for C, Abaqus and CalculiX.
    """

    # The source distribution, in the folder that DD3IMP_ARCHIVES names; Spack replaces the version.
    url = f"file://{Path(os.environ.get('DD3IMP_ARCHIVES', '.')).resolve()}/dd3imp-1.0.0.tar.gz"

    license("GPL-3.0-or-later")

    version("2.20.1")

    variant("mumps", default=False, description="Direct solver MUMPS, sequential")
    variant("utilities", default=True, description="The command dd3 and its Python packages")

    depends_on("c", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("lapack")
    depends_on("suite-sparse")
    depends_on("metis@5: ~int64")
    depends_on("hdf5+fortran+hl~mpi")
    depends_on("mumps~mpi", when="+mumps")
    with when("+utilities"), default_args(type="run"):
        depends_on("python@3.11:")
        depends_on("py-h5py")
        depends_on("py-matplotlib@3.6:")
        depends_on("py-numpy@1.24:")
        depends_on("py-pandas@1.5:")
        depends_on("py-scipy@1.10:")
        depends_on("py-tqdm")

    requires("%fortran=gcc@12:", msg="the options of the build are those of gfortran")

    generator("ninja")

    def cmake_args(self):
        """Return the options of the configuration."""
        return [self.define("BUILD_TESTING", False), self.define_from_variant("DD3_MUMPS", "mumps")]

    def setup_run_environment(self, env):
        """Let Python find the package dd3."""
        env.prepend_path("PYTHONPATH", self.prefix.share.dd3imp.python)
