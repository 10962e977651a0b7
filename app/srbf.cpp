#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <exception>

#include "app/commands.h"

int main(int argc, char** argv) {
    CLI::App app(
        "srbf: measured BRDFs as a handful of spherical radial basis functions.\n"
        "Fits a measurement (MERL .binary, RGL .bsdf), says how far off the fit is, evaluates and compares "
        "BRDFs.");
    app.name("srbf");
    app.set_version_flag("--version", "srbf " SRBF_VERSION);
    app.require_subcommand(1);
    app.footer(
        "Example:\n  srbf fit paper_white_rgb.bsdf --preview paper.png\n\n"
        "Exit status: 0 done, 1 something is wrong with an input or output (one line says what), 2 usage.");

    int status = srbf::k_done;
    srbf::add_fit(app, status);
    srbf::add_info(app, status);
    srbf::add_eval(app, status);
    srbf::add_compare(app, status);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& done) {  // --help, --version
        app.exit(done);
        status = srbf::k_done;
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "srbf: {} (srbf --help tells more)\n", error.what());
        return srbf::k_usage;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "srbf: out of memory\n");
        return srbf::k_input_error;
    }
    // What a full disk or a closed pipe did to standard output is known only now.
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) {
        fmt::print(stderr, "srbf: standard output: cannot be written\n");
        return srbf::k_input_error;
    }
    return status;
}
