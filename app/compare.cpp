#include "api/table_file.h"
#include "app/commands.h"
#include "app/fit_options.h"
#include "app/output.h"
#include "base/errors.h"
#include "base/printable.h"
#include "brdf/directions.h"
#include "errors/measures.h"
#include "fit/request_traits.h"
#include "srbf/fit.h"

namespace srbf {
namespace {

constexpr double k_default_max_theta = 80;  // [degrees]

struct CompareCommand {
    std::string reference, other, json;
    ReadOptions read;      // how the reference is read
    double max_theta = 0;  // [degrees]; 0: θmax of the model, or else k_default_max_theta
    int threads = 0;

    int run() const;
    int run_on_parts(const LoadedFile& a, const LoadedFile& b, double theta) const;
};

/// The names of the parts that the subject has.
std::string parts_text(const LoadedFile& subject) {
    std::vector<std::string_view> names;
    for (std::size_t p = 0; p < k_parts; ++p)
        if (has_part(subject.content, Part(p))) names.push_back(name(Part(p)));
    return fmt::format("{}", fmt::join(names, ", "));
}

/// Compares each part that both have. Beams of unscattered light are not a part of f and enter no measure.
int CompareCommand::run_on_parts(const LoadedFile& a, const LoadedFile& b, double theta) const {
    Json report{{"reference", reference}, {"other", other}, {"max_theta", theta}};
    bool has_common_part = false;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Part part = Part(p);
        if (!has_part(a.content, part) || !has_part(b.content, part)) continue;
        const Evaluate others[] = {part_of(evaluator(b), part)};
        const Comparison comparison = compare(part_of(evaluator(a), part), others, {theta * k_degree, threads},
                                              fibonacci_directions(k_matrix_directions, theta * k_degree))[0];
        if (comparison.matrix.pairs == 0 || comparison.heldout.pairs == 0) continue;
        if (!has_common_part && json != "-")
            fmt::print("{} against {}, directions within {:g}° of the normal, without beams\n", printable(other),
                       printable(reference), theta);
        has_common_part = true;
        Json measures;
        add_measures(measures, comparison);
        report[std::string(name(part))] = measures;
        if (json == "-") continue;
        fmt::print("\n{}\n", name(part));
        print_measures(comparison);
    }
    if (!has_common_part)
        return complain(input_error(fmt::format("{} and {}", reference, other), "parts", "one that both have",
                                    fmt::format("{}, and {}", parts_text(a), parts_text(b))));
    if (!json.empty())
        if (const auto written = write_json(report, json); !written) return complain(written.error());
    return k_done;
}

int CompareCommand::run() const {
    const auto a = load_file(reference, read);
    if (!a) return complain(a.error());
    const auto b = load_file(other);
    if (!b) return complain(b.error());

    const auto writable = check_outputs({reference, other}, {json == "-" ? "" : json});
    if (!writable) return complain(writable.error());

    double theta = max_theta;
    if (!(theta > 0)) theta = fitted_theta(*b);
    if (!(theta > 0)) theta = k_default_max_theta;
    if (is_two_sided(a->content) || is_two_sided(b->content)) return run_on_parts(*a, *b, theta);
    const Evaluate others[] = {evaluator(*b)};
    const auto* model = std::get_if<Model>(&b->content);
    const std::vector<Vec3f> directions = model ? matrix_directions(*model, theta * k_degree)
                                                : fibonacci_directions(k_matrix_directions, theta * k_degree);
    const MeasureOptions options{
        .max_theta = theta * k_degree, .threads = threads, .isotropic = is_isotropic(*a) && is_isotropic(*b)};
    const Comparison comparison = compare(evaluator(*a), others, options, directions)[0];

    if (comparison.matrix.pairs == 0 || comparison.heldout.pairs == 0)
        return complain(input_error(fmt::format("{} and {}", reference, other), "compared pairs of directions",
                                    "pairs with values in both", "none"));

    const auto exchanged = reciprocity_errors(a->content, threads);
    Json report{{"reference", reference}, {"other", other}, {"max_theta", theta}};
    add_measures(report, comparison);
    if (exchanged) report["exchanged_pictures"] = json_of(*exchanged);
    report["pairs"] = comparison.matrix.pairs;
    report["masked_pairs"] = comparison.matrix.masked;
    if (!json.empty())
        if (const auto written = write_json(report, json); !written) return complain(written.error());
    if (json == "-") return k_done;

    fmt::print("{} against {}, directions within {:g}° of the normal\n\n", printable(other), printable(reference),
               theta);
    print_measures(comparison);
    if (exchanged) fmt::print("\n{} is reciprocal {}\n", printable(reference), reciprocity_text(*exchanged));
    if (comparison.matrix.masked > 0)
        fmt::print("\n{} of {} pairs of the matrix were not measured and are skipped\n",
                   grouped(comparison.matrix.masked), grouped(comparison.matrix.masked + comparison.matrix.pairs));
    return k_done;
}

}  // namespace

void add_compare(CommandLine& app, int& status) {
    const auto command = std::make_shared<CompareCommand>();
    const Subcommand sub =
        app.add_subcommand("compare", "Report the errors of one BRDF against another, measured or fitted");
    sub.add_option("REFERENCE", command->reference, "The reference BRDF").type_name("").required();
    sub.add_option("OTHER", command->other, "The BRDF whose errors are measured").type_name("").required();
    sub.add_option("--max-theta", command->max_theta,
                   "Largest angle from the normal, 1 to 90 degrees;\n"
                   "default: that of OTHER's fit if it is a model, otherwise 80")
        .type_name("DEG")
        .check(within(1.0, 90.0));
    add_threads(sub, command->threads, "Number of threads; 0: all of the machine");
    add_read_options(sub, command->read);
    sub.add_option("--json", command->json, "Write the measures to this file; - is standard output").type_name("FILE");
    sub.footer(
        "--columns, --quantity and --floor describe REFERENCE.\n\n"
        "Example:\n  srbf compare paper_white_rgb.bsdf paper_white_rgb.srbf");
    sub.callback([command, &status] { status = command->run(); });
}

}  // namespace srbf
