# SPDX-License-Identifier: GPL-3.0-or-later
"""Recipe of Spack for a clone, see utils/packaging/README.md."""

from spack.package import depends_on, license, requires, variant, version
from spack_repo.builtin.build_systems.cmake import CMakePackage, generator


class Dd3imp(CMakePackage):
    """Implicit finite element simulation of sheet metal forming with rigid tools.

    Its constitutive laws are a library for C, Abaqus and CalculiX.
    """

    license("GPL-3.0-or-later")

    version("2.7.0")

    variant("mumps", default=False, description="Direct solver MUMPS, sequential")

    depends_on("c", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("lapack")
    depends_on("suite-sparse")
    depends_on("metis@5: ~int64")
    depends_on("hdf5+fortran+hl~mpi")
    depends_on("mumps~mpi", when="+mumps")

    requires("%fortran=gcc@12:", msg="the options of the build are those of gfortran")

    generator("ninja")

    def cmake_args(self):
        """Return the options of the configuration."""
        return [self.define("BUILD_TESTING", False), self.define_from_variant("DD3_MUMPS", "mumps")]
