// Converts all measurements and models in a folder to MERL tables: convert_folder FROM TO
#include <cstdio>
#include <filesystem>

#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/prepared.h"

namespace fs = std::filesystem;

/// The table of one file, or what is wrong with the file.
srbf::Result<srbf::Done> convert(const fs::path& from, const fs::path& to) {
    auto loaded = srbf::load_brdf(from.string());
    if (!loaded) return loaded.error();
    const auto* measured = std::get_if<srbf::Measured>(&*loaded);
    if (measured && !is_isotropic(*measured))
        return srbf::Error{from.string(), {}, "input", "an isotropic BRDF, as MERL tables are", "an anisotropic one"};
    const srbf::PreparedBrdf brdf =
        std::visit([](auto& any) { return srbf::prepare(std::move(any), srbf::CosineProposal{}); }, *loaded);
    return srbf::write_file(to.string(), srbf::write_merl(srbf::to_merl(srbf::evaluator(brdf))));
}

int main(int count, char** arguments) {
    if (count != 3) return std::puts("usage: convert_folder FROM TO"), 2;
    int failures = 0;
    std::error_code code;
    fs::create_directories(arguments[2], code);
    for (const auto& entry : fs::directory_iterator(arguments[1], code)) {
        if (!entry.is_regular_file()) continue;
        const fs::path to = fs::path(arguments[2]) / entry.path().stem().replace_extension(".binary");
        const auto done = convert(entry.path(), to);
        if (done) {
            std::printf("%s\n", to.string().c_str());
        } else {
            std::fprintf(stderr, "%s\n", message(done.error()).c_str());
            ++failures;
        }
    }
    if (code) return std::fprintf(stderr, "%s: %s\n", arguments[1], code.message().c_str()), 1;
    return failures > 0;
}
