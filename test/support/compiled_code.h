// Code that a test writes, compiles and calls.
#pragma once
#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstring>
#include <vector>

#include "temporary_folder.h"

namespace srbf {

inline testing::AssertionResult runs(const std::string& command) {
    FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    if (!pipe) return testing::AssertionFailure() << "cannot run " << command;
    std::string output;
    for (char part[256]; std::fgets(part, sizeof part, pipe);) output += part;
    const int status = ::pclose(pipe);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return testing::AssertionSuccess();
    return testing::AssertionFailure() << command << "\n" << output.substr(0, 4000);
}

/// The compiler of this build, for C, with warnings as errors.
#define SRBF_STRICT_C SRBF_COMPILER " -x c -std=c99 -pedantic -Wall -Wextra -Wconversion -Werror"

/// The function of C, with the prototype that warnings ask for.
inline std::string c_function(const std::string& signature, const std::string& body) {
    return signature + ";\n" + signature + " {\n" + body + "}\n";
}

/// A folder of source files, and compilers for them.
class CodeTest : public testing::Test {
  protected:
    ~CodeTest() override {
        for (void* library : loaded_) ::dlclose(library);
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    /// Writes a new file, and returns its path.
    std::string write_source(const std::string& name, const std::string& text) const {
        write_text(folder_ / name, text);
        return path(name);
    }

    /// Compiles C or C++ to a library, which is loaded until the test ends. After an error the result is null and the
    /// test fails.
    void* compile_and_load(const std::string& compiler, const std::string& name, const std::string& text,
                           const std::string& level = "-O1") {
        const std::string source = write_source(name + ".c", text), file = path(name + ".so");
        EXPECT_TRUE(runs(fmt::format("{} {} -shared -fPIC '{}' -o '{}' -lm", compiler, level, source, file)));
        void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (library)
            loaded_.push_back(library);
        else
            ADD_FAILURE() << ::dlerror();
        return library;
    }
    template <typename Function> static Function* function(void* library, const char* name) {
        return reinterpret_cast<Function*>(::dlsym(library, name));
    }

    /// True if glslang accepts a shader; the ending of NAME is its stage.
    testing::AssertionResult compiles_as_glsl(const std::string& name, const std::string& text) const {
        return glslang("", name, text);
    }
    /// Returns true if glslang accepts a shader in HLSL, and writes NAME.spv.
    testing::AssertionResult compiles_as_hlsl(const std::string& stage, const std::string& name,
                                              const std::string& text) const {
        return glslang(fmt::format("-D -V -S {} -e main -o '{}'", stage, path(name + ".spv")), name + ".hlsl", text);
    }

    const TemporaryFolder folder_;

  private:
    testing::AssertionResult glslang(const std::string& options, const std::string& name,
                                     const std::string& text) const {
        if (!std::strlen(SRBF_GLSLANG))
            return testing::AssertionFailure() << "glslangValidator (Debian: glslang-tools) was not found";
        return runs(fmt::format("'{}' {} '{}'", SRBF_GLSLANG, options, write_source(name, text)));
    }
    std::vector<void*> loaded_;
};

}  // namespace srbf
