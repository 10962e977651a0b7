"""Builds test/install against the package, and fits a measurement with it."""
from pathlib import Path

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, cmake_layout


class SrbfTest(ConanFile):
    settings = "os", "arch", "compiler", "build_type"
    generators = "CMakeDeps", "CMakeToolchain"

    def requirements(self):
        self.requires(self.tested_reference_str)

    def layout(self):
        cmake_layout(self)

    def build(self):
        cmake = CMake(self)
        cmake.configure(build_script_folder=str(self.root / "test" / "install"))
        cmake.build()

    def test(self):
        if can_run(self):
            user, paper = Path(self.build_folder) / "user", self.root / "data" / "paper_white_rgb.bsdf"
            self.run(f'"{user}" "{paper}" "{user}.srbf"', env="conanrun")

    @property
    def root(self):
        return Path(self.recipe_folder).parents[2]
