// The target that uses what a file holds: it prepares, evaluates and samples it, and runs the program on it.
#pragma once
#include "../test/support/exports.h"
#include "../test/support/models.h"
#include "in_process.h"
#include "targets.h"

namespace srbf {

/// True if a text contains "nan" or "inf" as a number. Bytes with a 0 are not text.
inline bool has_bad_number(std::string_view text) {
    if (text.find('\0') != text.npos) return false;
    const auto is_letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.'; };
    for (const std::string_view bad : {"nan", "inf"})
        for (std::size_t i = text.find(bad); i != text.npos; i = text.find(bad, i + 1))
            if ((i == 0 || !is_letter(text[i - 1])) &&
                (i + bad.size() == text.size() || !is_letter(text[i + bad.size()])))
                return true;
    return false;
}

/// A command on an input: the words after the program's name, and the extension of the output file.
struct Use {
    std::vector<std::string> words;
    std::string extension;
};
/// Commands on a file. `slow` are exports of pages, of materials of other programs and of code with additional
/// functions, and conversions; `quick` are the other exports.
struct Uses {
    std::vector<Use> quick, slow;
};
inline void add_conversions(Uses& uses) {
    for (const Format& format : formats())
        if (format.write) uses.slow.push_back({{"convert", "in"}, std::string(format.extension)});
}
inline Uses uses_of_models() {
    Uses uses;
    for (const std::string& kind : export_kinds()) {
        std::vector<std::string> words{"export", "in", "--to", kind};
        for (const std::string& option : quick_options(kind)) words.push_back(option);
        (is_slow_export(kind) ? uses.slow : uses.quick).push_back({std::move(words), ""});
    }
    for (const std::string& extra : export_option("--with").choices)
        uses.slow.push_back({{"export", "in", "--to", "c", "--with", extra}, ""});
    add_conversions(uses);
    return uses;
}
inline Uses uses_of_measurements() {
    Uses uses{{{{"info", "in"}, ""}}, {}};
#ifdef SRBF_RENDER
    uses.slow.push_back({{"export", "model", "--to", "html", "--reference", "in"}, ""});
#endif
    add_conversions(uses);
    return uses;
}

/// Prepares, evaluates and samples the BRDF of a file, and runs commands of the program on it: all quick ones and a
/// slow one, or in a fuzzer a single one. The sum of the bytes chooses.
inline void check_uses(std::span<const std::byte> bytes) {
    static const TemporaryFolder folder;
    static const Uses model_uses = uses_of_models(), measurement_uses = uses_of_measurements();
    const auto write = [](const char* name, std::span<const std::byte> content) {
        std::ofstream(folder.path / name, std::ios::binary)
            .write(reinterpret_cast<const char*>(content.data()), std::streamsize(content.size()));
    };
    std::size_t sum = 0;
    for (const std::byte b : bytes) sum += std::size_t(b);
    write("in", bytes);
    const std::string path = (folder.path / "in").string();
    auto brdf = load_brdf(path);
    if (!brdf) brdf = load_brdf(path + "#0");  // a texel of a map, which is exported whole
    if (!brdf) return;
    const bool is_model = std::holds_alternative<Model>(*brdf);
    const PreparedBrdf prepared = std::visit(
        [&](const auto& kind) { return sum % 8 == 0 ? prepare(kind) : prepare(kind, CosineProposal{}); }, *brdf);
    check_values(Result<PreparedBrdf>(prepared));
    check_samples(prepared);
    if (sum % 8 == 0) return check_albedo(prepared);

    if (!is_model) write("model", write_model({grey_facets(), {}}));
    const Uses& uses = is_model ? model_uses : measurement_uses;
    const auto run = [&](const Use& use) {
        std::vector<std::string> words = use.words;
        words.insert(words.begin(), "srbf");
        const std::string out = "out" + use.extension;
        if (use.words[0] != "info") words.insert(words.end(), {"-o", out});
        const InProcess done = run_in_process(folder.path, words);
        const std::string line = fmt::format("{}: ", fmt::join(words, " ")), text = read_text(folder.path / out);
        require(done.status != k_usage, line + "only a file is wrong");
        require(done.status == k_done || text.empty(), line + "an error writes nothing");
        require(!has_bad_number(text), line + "numbers are finite");
        std::filesystem::remove(folder.path / out);
    };
#ifdef SRBF_FUZZ_TARGET  // A fuzzer should try many files.
    const std::size_t chosen = sum / 8 % (uses.quick.size() + uses.slow.size());
    run(chosen < uses.quick.size() ? uses.quick[chosen] : uses.slow[chosen - uses.quick.size()]);
#else
    for (const Use& use : uses.quick) run(use);
    run(uses.slow[sum / 8 % uses.slow.size()]);
#endif
    for (const auto& entry : std::filesystem::directory_iterator(folder.path))
        std::filesystem::remove_all(entry.path());
}

}  // namespace srbf
