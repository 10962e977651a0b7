#include <hwy/targets.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <system_error>

#include "app/commands.h"
#include "app/memory.h"
#include "app/output.h"
#include "generated/app/extra_subcommands.h"
#include "measured/formats.h"

namespace srbf {
namespace {

/// Limits vectors to the instruction set named by the environment variable SRBF_INSTRUCTIONS, as Highway calls it,
/// or older ones. Returns an error message if there is no such set.
std::optional<std::string> limit_instructions() {
    const char* const wanted = std::getenv("SRBF_INSTRUCTIONS");
    if (!wanted) return {};
    auto candidates = hwy::SupportedTargets(),
         newer = candidates - candidates;  // bit sets; newer targets have lower bits
    std::string names;
    for (; candidates != 0; candidates &= candidates - 1) {
        const auto target = candidates & -candidates;
        if (std::string_view(hwy::TargetName(target)) == wanted) {
            hwy::DisableTargets(newer);
            return {};
        }
        newer |= target;
        names += std::string(names.empty() ? "" : ", ") + hwy::TargetName(target);
    }
    return fmt::format("SRBF_INSTRUCTIONS: expected one of {}, found {}", names, wanted);
}

/// Reports exhausted memory where no exception can be caught: destructors of JSON and starting threads allocate.
[[noreturn]] void end_without_memory() noexcept {
    try {
        if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
        std::fputs("srbf: out of memory\n", stderr);
        std::_Exit(srbf::k_input_error);
    } catch (...) {  // a defect
    }
    std::abort();
}

}  // namespace

void add_subcommands(CommandLine& app, int& status) {
    app.add_option(
           "--max-memory", [](const std::string& text) { limit_memory(std::stoi(text)); },
           "Limit the program's memory [MB], for files of unknown origin; excludes OpenGL")
        .type_name("MB")
        .check(within<int>(64, 1'000'000'000));
    add_fit(app, status);
    add_info(app, status);
    add_eval(app, status);
    add_compare(app, status);
    add_convert(app, status);
    add_edit(app, status);
    add_blend(app, status);
    add_export(app, status);
    for (const auto add : k_extra_subcommands) add(app, status);
    add_completion(app, status);
}

int run_program(int argc, char** argv) {
    std::set_terminate(end_without_memory);
#ifdef SIGXFSZ
    std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit of a file's size fails with EFBIG
#endif
    CommandLine app(
        "srbf", "srbf " SRBF_VERSION " (" SRBF_DATE ")",
        "srbf: measured BRDFs as a few spherical radial basis functions.\n"
        "Reads measurements, fits models to them and reports the errors; evaluates, compares, converts, edits,\n"
        "renders and exports BRDFs. A measurement is a file of " +
            names_of_formats() + ".",
        "Example:\n  srbf fit paper_white_rgb.bsdf --preview paper.png\n\n"
        "Exit status: 0: success. 2: the command line is invalid regardless of the files' content. 1: a file, a\n"
        "folder or the machine caused the error. An error is one line. With several inputs, the others are still\n"
        "processed.");

    if (const auto problem = limit_instructions()) {
        complain({{}, {}, *problem, {}, {}});
        return k_usage;
    }
    int status = k_done;
    add_subcommands(app, status);
    try {
        if (const auto problem = app.parse(argc, argv)) {
            complain({{}, {}, *problem, {}, {}});
            return k_usage;
        }
    } catch (const std::bad_alloc&) {  // an error while reading a file is reported by its reader
        std::fputs("srbf: out of memory\n", stderr);
        return k_input_error;
    } catch (const std::filesystem::filesystem_error& error) {
        return complain({error.path1().string(), {}, "cannot be read", {}, error.code().message()});
    } catch (const std::system_error& error) {  // fmt throws it if standard output fails
        return complain({"standard output", {}, "cannot be written", {}, error.code().message()});
    }
    // A full disk may be reported only when standard output is flushed.
    const auto flushed = flush_standard_output();
    if (!flushed && status == k_done) return complain(flushed.error());
    return status;
}

}  // namespace srbf
