#include <fmt/format.h>
#include <hwy/targets.h>

#include <cstdlib>
#include <new>
#include <optional>
#include <string>
#include <system_error>

#include "app/commands.h"
#include "app/output.h"

namespace {

/// Limits vectors to the instruction set that the environment variable SRBF_INSTRUCTIONS names, as Highway calls it, or
/// older ones. Returns what is wrong.
std::optional<std::string> limit_instructions() {
    const char* const wanted = std::getenv("SRBF_INSTRUCTIONS");
    if (!wanted) return {};
    auto left = hwy::SupportedTargets(), newer = left - left;  // a set of bits, of which a newer set has a lower one
    std::string names;
    for (; left != 0; left &= left - 1) {
        const auto target = left & -left;
        if (std::string_view(hwy::TargetName(target)) == wanted) {
            hwy::DisableTargets(newer);
            return {};
        }
        newer |= target;
        names += std::string(names.empty() ? "" : ", ") + hwy::TargetName(target);
    }
    return fmt::format("SRBF_INSTRUCTIONS: expected one of {}, found {}", names, wanted);
}

}  // namespace

int main(int argc, char** argv) {
    srbf::CommandLine app(
        "srbf", "srbf " SRBF_VERSION " (" SRBF_DATE ")",
        "srbf: measured BRDFs as a few spherical radial basis functions.\n"
        "Reads measurements (MERL, RGL, UTIA, MBSDF, Cornell, ASTM E1392, ALTA, CSV, BSDF XML), fits models to them\n"
        "and reports the errors; evaluates, compares, converts, renders and exports BRDFs.",
        "Example:\n  srbf fit paper_white_rgb.bsdf --preview paper.png\n\n"
        "Exit status: 0 success, 1 an error of input or output (reported in one line), 2 wrong usage.");

    if (const auto wrong = limit_instructions()) {
        srbf::complain({{}, {}, *wrong, {}, {}});
        return srbf::k_usage;
    }
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
    srbf::add_manual(app, status);
    try {
        if (const auto wrong = app.parse(argc, argv)) {
            srbf::complain({{}, {}, *wrong + " (see srbf --help)", {}, {}});
            return srbf::k_usage;
        }
    } catch (const std::bad_alloc&) {
        return srbf::complain({{}, {}, "out of memory", {}, {}});
    } catch (const std::system_error& error) {  // from fmt, if standard output fails
        return srbf::complain({"standard output", {}, "cannot be written", {}, error.code().message()});
    }
    // A full disk may be reported for standard output only now.
    const auto flushed = srbf::flush_standard_output();
    if (!flushed && status == srbf::k_done) return srbf::complain(flushed.error());
    return status;
}
