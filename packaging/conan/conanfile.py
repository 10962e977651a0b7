"""The library for Conan 2: `conan create packaging/conan`. -o "srbf/*:system=True" links packages of the system."""
import re
from pathlib import Path

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy
from conan.tools.system.package_manager import Apt

FOLDERS = ("CMakeLists.txt", "LICENSE", "cmake/*", "include/*", "src/*", "extras/*", "data/*")


class Srbf(ConanFile):
    name = "srbf"
    license = "MIT"
    description = "Measured BRDFs as a handful of spherical radial basis functions"
    settings = "os", "arch", "compiler", "build_type"
    package_type = "library"
    options = {"shared": [True, False], "fPIC": [True, False], "system": [True, False]}
    default_options = {"shared": False, "fPIC": True, "system": False}
    implements = ["auto_shared_fpic"]

    def set_version(self):
        text = (Path(self.recipe_folder).parents[1] / "CMakeLists.txt").read_text()
        self.version = re.search(r"project\(srbf VERSION ([0-9.]+)", text).group(1)

    def export_sources(self):
        for files in FOLDERS:
            copy(self, files, Path(self.recipe_folder).parents[1], self.export_sources_folder)

    def requirements(self):
        if not self.options.system:
            for linked in ("onetbb/2021.12.0", "highway/1.2.0", "fmt/10.2.1", "pugixml/1.14"):
                self.requires(linked)
            for headers in ("eigen/3.4.0", "nlohmann_json/3.11.3", "nanoflann/1.6.0"):
                self.requires(headers, visible=False)

    def system_requirements(self):
        if self.options.system:
            Apt(self).install(["libeigen3-dev", "libhwy-dev", "libtbb-dev", "nlohmann-json3-dev", "libfmt-dev",
                               "libpugixml-dev", "libnanoflann-dev"])

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables.update({"SRBF_LIBRARY_ONLY": True, "SRBF_TESTS": False})
        toolchain.generate()
        dependencies = CMakeDeps(self)
        dependencies.set_property("highway", "cmake_file_name", "hwy")
        dependencies.set_property("highway::highway", "cmake_target_name", "hwy::hwy")
        dependencies.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        self.cpp_info.set_property("cmake_find_mode", "none")  # by the package's own srbf-config.cmake
        self.cpp_info.builddirs = ["lib/cmake/srbf"]
