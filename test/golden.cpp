// golden DATA TABLE [--instructions NAME | --older [--every]] [--threads N] [--only ROW] [--write]
//
// Compares fits of every kind with a table of hashes of their models and figures, which are the same on every
// processor. DATA is the folder of the bundled measurements. --older runs with the processor's older instruction
// sets, with some rows or, with --every, all of them. --write replaces the table, for changes that intentionally
// change fits. This is a separate program so that it runs wherever the library does.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <sstream>

#include "brdf/directions.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "srbf/file.h"
#include "srbf/fit.h"
#include "srbf/kernel.h"
#include "srbf/model.h"
#include "support/brdf_functions.h"
#include "support/one_target.h"

namespace srbf {
namespace {

/// An FNV-1a hash.
class Hash {
  public:
    void add(std::span<const std::byte> bytes) {
        for (const std::byte b : bytes) state_ = (state_ ^ std::uint64_t(b)) * 1099511628211u;
    }
    void add(double x) { add(std::as_bytes(std::span(&x, 1))); }
    void add(const Measures& measures) {
        for (const MeasureName& measure : k_measures) add(measures.*measure.member);
        add(double(measures.pairs));
        add(double(measures.masked));
    }
    void add(const PictureErrors& errors) {
        for (const PictureErrorName& error : k_picture_errors) add(errors.*error.member);
    }
    void add(const Comparison& comparison) {
        add(comparison.matrix);
        add(comparison.heldout);
        add(comparison.albedo_error);
        add(comparison.appearance.mean);
        for (const PictureErrors& lighting : comparison.appearance.lighting) add(lighting);
    }
    std::string text() const {
        char digits[17];
        std::snprintf(digits, sizeof digits, "%016" PRIx64, state_);
        return digits;
    }

  private:
    std::uint64_t state_ = 14695981039346656037u;
};

std::string hash_of(Model model) {
    model.provenance.clear();  // contains the version of the program
    Hash hash;
    hash.add(write_model(model));
    return hash.text();
}

/// A row of the table.
struct TableRow {
    std::string model, figures;  ///< hashes
    std::string delta_e, error;  ///< to read: mean ΔE_ITP and the held-out error of f cosθl, if available
};

[[noreturn]] void fail(const std::string& why) {
    std::fprintf(stderr, "golden: %s\n", why.c_str());
    std::exit(1);
}
template <typename T> T value_or_fail(Result<T> result) {
    if (!result) fail(message(result.error()));
    return *std::move(result);
}

std::string digits(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

TableRow row_of(const FitOutcome& outcome) {
    Hash figures;
    figures.add(*outcome.errors);
    figures.add(double(outcome.masked));
    figures.add(double(outcome.clamped));
    for (const Trial& step : outcome.path) figures.add(step.error);
    // For a view-by-view model with many views, errors are measured at a subset of the pairs.
    return {hash_of(outcome.model), figures.text(), digits(outcome.errors->appearance.mean.delta_e),
            digits(outcome.errors->heldout.squared_error_ratio_cosine)};
}

/// A diffuse base below a GGX varnish, which has a closed form.
Evaluate varnished(float roughness, Rgb body) {
    return pairwise([=](Vec3f wl, Vec3f wv) {
        using K = Kernel<float>;
        const K::GgxLobe varnish{roughness, {0.04f, 0.04f, 0.04f}, 1};
        const Vec3f f = K::ggx_value({body.r, body.g, body.b}, varnish, {1, {0, 0, 0}, 0}, wl, wv);
        return wl.z > 0 && wv.z > 0 ? Rgb{f.x, f.y, f.z} : Rgb{};
    });
}

/// Pairs of directions up to 80° from the normal, many of them close to the mirror direction.
struct Pairs {
    std::vector<Vec3f> wl, wv;
};
Pairs some_pairs(std::size_t count) {
    const MirrorMixture mixture(80 * k_degree);
    std::mt19937_64 random(1);
    Pairs pairs;
    while (pairs.wl.size() < count) {
        const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random), u4 = uniform(random),
                     u5 = uniform(random);
        const Vec3d v = mixture.sample_cap(u1, u2), l = mixture.sample(v, u3, u4, u5);
        if (!mixture.contains(l)) continue;
        pairs.wl.push_back(to_float(l));
        pairs.wv.push_back(to_float(v));
    }
    return pairs;
}

/// The measurement at these pairs as the text of a CSV file. If `is_spectral`, it has five wavelengths instead of
/// colours.
Measured samples_of(const Measured& measured, std::size_t count, bool is_spectral) {
    const Pairs pairs = some_pairs(count);
    std::vector<Rgb> f(count);
    evaluator(measured)(pairs.wl, pairs.wv, f);
    std::string text = is_spectral ? "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,450nm,500nm,550nm,600nm,650nm\n"
                                   : "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,r,g,b\n";
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3f l = pairs.wl[i], v = pairs.wv[i];
        std::vector<float> numbers{l.x, l.y, l.z, v.x, v.y, v.z};
        if (is_spectral)
            for (const float x : {f[i].b, 0.5f * (f[i].g + f[i].b), f[i].g, 0.5f * (f[i].r + f[i].g), f[i].r})
                numbers.push_back(x);
        else
            numbers.insert(numbers.end(), {f[i].r, f[i].g, f[i].b});
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            char number[32];
            std::snprintf(number, sizeof number, "%s%.9g", k > 0 ? "," : "", double(numbers[k]));
            text += number;
        }
        text += '\n';
    }
    return value_or_fail(read_measured(as_bytes(text), "samples.csv"));
}

struct Golden {
    Measured paper, film;
    int threads;  ///< 0: all of the machine

    FitRequest request(PmRequest pm, Objective objective = k_default_objective) const {
        return {.model = pm, .objective = objective, .threads = threads};
    }
    TableRow fitted(const Measured& measured, const FitRequest& fit_request) const {
        return row_of(value_or_fail(fit(measured, fit_request)));
    }
    TableRow pm_row(const Measured& measured, int lobes, Objective objective = k_default_objective,
                    PmRequest pm = {.form = PmForm::extended}) const {
        pm.size = LobeCount{lobes};
        return fitted(measured, request(pm, objective));
    }
    TableRow su_row(const Measured& measured, SuRequest su, Objective objective) const {
        return fitted(measured, {.model = su, .objective = objective, .threads = threads});
    }
    TableRow bsdf_row() const {
        const Evaluate front = varnished(0.3f, {0.4f, 0.3f, 0.2f}), back = varnished(0.5f, {0.2f, 0.3f, 0.4f}),
                       through = varnished(0.7f, {0.1f, 0.2f, 0.1f});
        const BsdfOutcome outcome =
            value_or_fail(fit_bsdf(std::array{front, back, through, through},
                                   request({.size = LobeCount{2}, .effort = 0.2}, Objective::cosine)));
        Hash figures;
        for (const PartFit& part : outcome.parts) figures.add(part.squared_error_ratio);
        for (const Hemispherical& hemispherical : outcome.parts[0].hemispherical) figures.add(hemispherical.fitted);
        return {hash_of(outcome.model), figures.text(), "", digits(outcome.parts[0].squared_error_ratio)};
    }
};

struct NamedFit {
    const char* name;
    std::function<TableRow(const Golden&)> fit;
};
const std::vector<NamedFit>& fits() {
    using G = Golden;
    static const std::vector<NamedFit> list{
        {"paper", [](const G& g) { return g.pm_row(g.paper, 8); }},
        {"film", [](const G& g) { return g.pm_row(g.film, 8); }},
        {"film-3-general",
         [](const G& g) {
             return g.pm_row(g.film, 3, k_default_objective, {.form = PmForm::extended, .axial = false, .effort = 0.3});
         }},
        {"film-3-source", [](const G& g) { return g.pm_row(g.film, 3, Objective::raw, {.form = PmForm::gaussian}); }},
        {"paper-reciprocal", [](const G& g) { return g.fitted(g.paper, g.request({})); }},
        {"film-reciprocal", [](const G& g) { return g.fitted(g.film, g.request({})); }},
        {"film-3-reciprocal-general",
         [](const G& g) {
             return g.pm_row(g.film, 3, Objective::cosine, {.form = PmForm::reciprocal, .axial = false, .effort = 0.3});
         }},
        {"paper-3-log", [](const G& g) { return g.pm_row(g.paper, 3, Objective::log, {.form = PmForm::extended}); }},
        {"film-3-cube-root", [](const G& g) { return g.pm_row(g.film, 3, Objective::cube_root); }},
        {"film-views",
         [](const G& g) { return g.su_row(g.film, {.lobes = 3, .directions = 96}, k_default_objective); }},
        {"film-lights",
         [](const G& g) {
             return g.su_row(g.film, {.lobes = 2, .discretise = Discretise::light, .directions = 64}, Objective::raw);
         }},
        {"film-ggx", [](const G& g) { return g.fitted(g.film, {.model = GgxRequest{2}, .threads = g.threads}); }},
        {"film-openpbr",
         [](const G& g) { return g.fitted(g.film, {.model = OpenPbrRequest{}, .threads = g.threads}); }},
        {"film-samples",
         [](const G& g) {
             return g.pm_row(samples_of(g.film, 300, false), 3, k_default_objective,
                             {.form = PmForm::extended, .effort = 0.3});
         }},
        {"film-spectra",
         [](const G& g) {
             FitRequest request = g.request({.size = LobeCount{2}, .effort = 0.2}, Objective::cosine);
             request.spectral = true;
             return g.fitted(samples_of(g.film, 160, true), request);
         }},
        {"both-sides", [](const G& g) { return g.bsdf_row(); }},
    };
    return list;
}

/// The rows of the table by name. Empty if the file does not exist.
std::map<std::string, TableRow> read_table(const std::string& path) {
    std::map<std::string, TableRow> table;
    const auto bytes = read_file(path);
    if (!bytes) return table;
    std::istringstream file(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()));
    std::string text, name;
    std::getline(file, text);  // the names of the columns
    while (std::getline(file, text)) {
        std::istringstream columns(text);
        TableRow row;
        std::getline(columns, name, ',');
        for (std::string* column : {&row.model, &row.figures, &row.delta_e, &row.error})
            std::getline(columns, *column, ',');
        table[name] = row;
    }
    return table;
}

/// The processor's instruction sets for which the library was compiled, newest first.
std::vector<std::string> instruction_sets() {
    std::vector<std::string> names;
    for (const auto target : hwy::SupportedAndGeneratedTargets()) names.push_back(hwy::TargetName(target));
    return names;
}
/// Restricts the library to one instruction set until the next call.
void limit_to(const std::string& name) {
    static std::unique_ptr<OneTarget> target_limit;
    target_limit.reset();
    for (const auto target : hwy::SupportedAndGeneratedTargets())
        if (hwy::TargetName(target) == name) target_limit = std::make_unique<OneTarget>(target);
    if (!target_limit) fail("this processor has no " + name);
}

/// Fits the wanted rows and returns how many differ from the table. Appends their lines to `text`, and the table's
/// lines for the other rows.
int compare_rows(const Golden& golden, const std::map<std::string, TableRow>& table,
                 const std::function<bool(const NamedFit&)>& is_wanted, std::string& text) {
    int differing = 0;
    for (const NamedFit& named_fit : fits()) {
        const auto entry = table.find(named_fit.name);
        const TableRow expected = entry == table.end() ? TableRow{} : entry->second;
        const bool is_fitted = is_wanted(named_fit);
        const TableRow row = is_fitted ? named_fit.fit(golden) : expected;
        text += std::string(named_fit.name) + ',' + row.model + ',' + row.figures + ',' + row.delta_e + ',' +
                row.error + '\n';
        if (!is_fitted) continue;
        const auto print = [](const char* label, const TableRow& printed) {
            std::printf("%s: model %s, figures %s, delta E %s, error %s\n", label, printed.model.c_str(),
                        printed.figures.c_str(), printed.delta_e.c_str(), printed.error.c_str());
        };
        const bool same = row.model == expected.model && row.figures == expected.figures;
        differing += !same;
        print(named_fit.name, row);
        if (!same) print("  DIFFERS, expected", expected);
        std::fflush(stdout);
    }
    return differing;
}

int run(const std::vector<std::string>& arguments) {
    if (arguments.size() < 2) fail("expected the folder of data and the table");
    const std::string &data = arguments[0], &path = arguments[1];
    Golden golden{value_or_fail(load_measured(data + "/paper_white_rgb.bsdf")),
                  value_or_fail(load_measured(data + "/cc_ibiza_sunset_rgb.bsdf")), 0};
    const std::map<std::string, TableRow> table = read_table(path);
    std::string only;
    bool is_writing = false, is_older = false, every = false;
    for (std::size_t i = 2; i < arguments.size(); ++i) {
        const bool has_value = i + 1 < arguments.size();
        if (arguments[i] == "--write")
            is_writing = true;
        else if (arguments[i] == "--older")
            is_older = true;
        else if (arguments[i] == "--every")
            every = true;
        else if (arguments[i] == "--instructions" && has_value)
            limit_to(arguments[++i]);
        else if (arguments[i] == "--threads" && has_value)
            golden.threads = std::atoi(arguments[++i].c_str());
        else if (arguments[i] == "--only" && has_value)
            only = arguments[++i];
        else
            fail("unknown argument " + arguments[i]);
    }
    std::string text = "fit,model,figures,delta_e_itp,error\n";
    int failed = 0;
    if (is_older) {
        const std::vector<std::string> sets = instruction_sets();
        for (std::size_t i = 1; i < sets.size(); ++i) {
            limit_to(sets[i]);
            golden.threads = i == 1 ? 7 : 1;
            std::printf("%s, %d threads\n", sets[i].c_str(), golden.threads);
            // Fits with narrow vectors are slow: the next older set runs the default fit and a row of each kind that
            // has loops of its own for each set, the next one fewer, the rest one.
            const std::vector<std::string> selected{"film-lights", "film-3-general", "paper-reciprocal", "film-views",
                                                    "film-openpbr"};
            const std::ptrdiff_t count = every ? std::ssize(fits()) : i == 1 ? std::ssize(selected) : i == 2 ? 3 : 1;
            const auto is_wanted = [&](const NamedFit& named_fit) {
                return every || std::find(selected.begin(), selected.end(), named_fit.name) - selected.begin() < count;
            };
            failed += compare_rows(golden, table, is_wanted, text);
        }
    } else {
        failed = compare_rows(
            golden, table, [&](const NamedFit& named_fit) { return only.empty() || only == named_fit.name; }, text);
    }
    if (is_writing) {
        std::FILE* const file = std::fopen(path.c_str(), "w");
        if (!file || std::fputs(text.c_str(), file) < 0 || std::fclose(file) != 0) fail("cannot write " + path);
        return 0;
    }
    std::printf("%d differ\n", failed);
    return failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace srbf

int main(int count, char** arguments) { return srbf::run({arguments + 1, arguments + count}); }
