#include <fmt/format.h>

#include <new>
#include <system_error>

#include "app/commands.h"
#include "app/report.h"

int main(int argc, char** argv) {
    CLI::App app(
        "srbf: measured BRDFs as a handful of spherical radial basis functions.\n"
        "Reads measurements (MERL, RGL, UTIA, Cornell, ASTM E1392, ALTA, CSV), fits them, says how far off the\nfit "
        "is, evaluates, compares, converts, renders and exports BRDFs.");
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
    srbf::add_convert(app, status);
    srbf::add_render(app, status);
    srbf::add_view(app, status);
    srbf::add_export(app, status);
    srbf::add_report(app, status);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& done) {  // --help, --version
        app.exit(done);
        status = srbf::k_done;
    } catch (const CLI::ParseError& error) {
        // CLI11 asks for what is missing before it tells what it did not understand.
        const auto unknown = app.remaining(true);
        const bool is_missing = error.get_exit_code() == int(CLI::ExitCodes::RequiredError);
        const std::string what =
            is_missing && !unknown.empty() ? "no such subcommand or option: " + unknown[0] : error.what();
        srbf::complain({{}, {}, what + " (srbf --help tells more)", {}, {}});
        return srbf::k_usage;
    } catch (const std::bad_alloc&) {
        return srbf::complain({{}, {}, "out of memory", {}, {}});
    } catch (const std::system_error& error) {  // fmt's, where standard output takes no more
        return srbf::complain({"standard output", {}, "cannot be written", {}, error.code().message()});
    }
    // What a full disk did to standard output may be known only now.
    const auto flushed = srbf::flush_standard_output();
    if (!flushed && status == srbf::k_done) return srbf::complain(flushed.error());
    return status;
}
